// problem_files.hpp - the command line of programs that run through files of contact problems.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact_problem.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

struct ProblemFiles {
  double limit = 3.0;  // seconds for a solution
  std::vector<std::string> names;

  // The exit code where the line is wrong or asks for help.
  std::optional<int> parse(int argc, char** argv, const char* description) {
    CLI::App app(description);
    app.add_option("--limit", limit, "Seconds for a solution")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    app.add_option("FILE", names, "Problems, as Siconos writes them or of FCLIB")->required();
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    return {};
  }

  // Calls visit(name without folders, problem); a file that has none is told and left out.
  template <class Visit>
  void for_each(Visit visit) const {
    for (const std::string& name : names) {
      Problem problem;
      if (read(name.c_str(), problem))
        visit(name.substr(name.rfind('/') + 1), problem);
      else
        std::fprintf(stderr, "%s: not a local problem of contacts in dimension 3\n", name.c_str());
    }
  }
};

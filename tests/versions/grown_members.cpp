// grown_members LIBRARY... - reads, as a host of a later version, the members that only it knows: whatever
// older libraries never wrote is zero.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include <cstdio>
#include <cstring>
#include <vector>

namespace {

int wrong = 0;

template <class Struct>
void expect_zero(const Struct& read, const char* what, const std::string& path) {
  if (read.grown == 0.0 && read.struct_size >= sizeof read) return;
  std::fprintf(stderr, "%s: %s: the new member is %g in a struct of %u bytes\n", path.c_str(), what,
               read.grown, read.struct_size);
  ++wrong;
}

void check_instance(const ilaw::library& library, const ilaw_law& law) {
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_SCALAR;
  setup.frame = ILAW_FRAME_LOCAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  std::vector<ilaw_argument> arguments;
  for (std::uint32_t p = 0; p < law.parameter_count; ++p)
    if (law.parameters[p]->flags & ILAW_FLAG_REQUIRED) {
      ilaw_argument& a = arguments.emplace_back();
      a.struct_size = sizeof a;
      a.name = law.parameters[p]->name;
      a.number = law.parameters[p]->minimum + 0.5;
    }
  std::vector<const ilaw_argument*> pointers;
  for (const ilaw_argument& a : arguments) pointers.push_back(&a);
  setup.arguments = pointers.data();
  setup.argument_count = static_cast<std::uint32_t>(pointers.size());
  const ilaw::interface interface(library, law.id, setup);
  const ilaw_instance_info info = interface.info();
  expect_zero(info, "info", library.path());
  for (std::uint32_t v = 0; v < info.state_variable_count; ++v)
    expect_zero(*info.state_variables[v], "state variable of an instance", library.path());
  for (std::uint32_t a = 0; a < info.amount_count; ++a)
    expect_zero(*info.amounts[a], "amount of an instance", library.path());
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.velocity_step = batch.position_step = 1e-3;
  ilaw_report report;
  std::memset(&report, 0xFF, sizeof report);
  report.struct_size = sizeof report;
  if (interface.evaluate(batch, &report) != ILAW_OK) ++wrong;
  expect_zero(report, "report", library.path());
}

void check(const ilaw::library& library) {
  const ilaw_plugin& plugin = library.plugin();
  expect_zero(plugin, "plugin", library.path());
  for (std::uint32_t i = 0; i < plugin.law_count; ++i) {
    const ilaw_law& law = *plugin.laws[i];
    expect_zero(law, "law", library.path());
    for (std::uint32_t p = 0; p < law.parameter_count; ++p)
      expect_zero(*law.parameters[p], "parameter", library.path());
    for (std::uint32_t v = 0; v < law.state_variable_count; ++v)
      expect_zero(*law.state_variables[v], "state variable", library.path());
    for (std::uint32_t a = 0; a < law.amount_count; ++a)
      expect_zero(*law.amounts[a], "amount", library.path());
    check_instance(library, law);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    for (int k = 1; k < argc; ++k) check(ilaw::library(argv[k]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "grown_members: %s\n", error.what());
    return 1;
  }
  return wrong == 0 ? 0 : 1;
}

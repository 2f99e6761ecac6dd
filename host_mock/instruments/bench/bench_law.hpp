// bench_law.hpp - an instance of a law for the batches of a case, and what the law tells of its code.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/bench_case.hpp"

#include <ilaw/ext/draft/profile.h>
#include <ilaw/loader.hpp>

#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

std::vector<std::string> laws_of(const ilaw::library& library);

// A case with every parameter that its law requires: where one is missing, a plain value of its range is
// taken, so that any law can be measured.
BenchCase with_required_parameters(BenchCase bench_case, const ilaw_law& law);

class BenchLaw {
 public:
  // Throws InputError or ilaw::error where the law does not serve the case.
  BenchLaw(const ilaw::library& library, const BenchCase& bench_case);

  const ilaw_instance_info& info() const { return info_; }
  const ilaw_law& law() const { return interface_->law(); }
  int dimension() const { return dimension_; }
  const std::vector<double>& per_node_values() const { return per_node_values_; }

  // Throw std::runtime_error with the law's reason where it refuses a node.
  void initialise(const ilaw_batch& batch) const;
  void evaluate(const ilaw_batch& batch) const;

  // Empty where the law cannot say.
  std::optional<std::string> instruction_set() const;
  std::optional<double> scalar_share(const ilaw_batch& batch) const;

 private:
  template <class Call>
  void checked(const char* call, Call make) const;

  std::string name_, path_;
  std::optional<ilaw::interface> interface_, floats_;  // floats_: of a case with arrays of float
  ilaw_instance_info info_{};
  const ilaw_profile* profile_ = nullptr;
  int dimension_ = 3;
  std::vector<double> per_node_values_;  // one for each parameter given per node, in their order
};

}  // namespace ilaw::host

// law.hpp - a law as this host holds it: the library, the instance made from a scene's parameters,
// and its two calls, initialise and evaluate.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "contact/law_arguments.hpp"
#include "contact/refusal.hpp"

#include <ilaw/loader.hpp>

#include <cstdint>
#include <string>

namespace ilaw::host {

class Law {
 public:
  // Loads the library, by name or path, and creates the law; throws as create_law. Messages name the
  // interface, whose name must live as long.
  Law(const std::string& library, const std::string& law, const Arguments& arguments, const Vector& tangent,
      int dimension, const std::string& interface, std::uint32_t delassus_form = ILAW_DELASSUS_SCALAR);

  const ilaw::library& library() const { return library_; }
  const ilaw_instance_info& info() const { return info_; }
  const char* id() const { return id_; }
  // ILAW_OUTPUT_*: what it gives.
  std::uint32_t outputs() const { return outputs_; }
  bool may_skip_fresh() const { return (info_.permissions & ILAW_MAY_SKIP_FRESH) != 0; }
  bool bonds_at_once() const { return (info_.capabilities & ILAW_CAN_ADHERE) != 0 && !may_skip_fresh(); }
  bool may_skip_free() const { return (info_.permissions & ILAW_MAY_SKIP_FREE) != 0; }
  // Where in the state axes begin: they turn with the normal from step to step, and with an obstacle.
  std::vector<std::size_t> axes() const;

  Answer initialise(const ilaw_batch& batch) const { return answer_of(ilaw_interface_initialise, batch); }
  Answer evaluate(const ilaw_batch& batch) const { return answer_of(ilaw_interface_evaluate, batch); }

 private:
  using Call = decltype(&ilaw_interface_evaluate);
  Answer answer_of(Call call, const ilaw_batch& batch) const;

  ilaw::library library_;
  ilaw::interface interface_;
  ilaw_instance_info info_;
  std::uint32_t outputs_;
  const char *id_, *interface_name_;
};

}  // namespace ilaw::host

// coupled.hpp - coupled.h for C++20: an owner instead of a handle, exceptions instead of codes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/coupled.h>
#include <ilaw/loader.hpp>

#include <cstdint>
#include <memory>
#include <new>
#include <span>

namespace ilaw {

// Movable; one solve at a time.
class coupled {
 public:
  coupled() : handle_(ilaw_coupled_create()) {
    if (!handle_) throw std::bad_alloc();
  }

  // Throws where the call is refused. Contacts with bad input are no exception: report.bad_count.
  ilaw_coupled_report solve(const ilaw_bodies& bodies, std::span<const ilaw_contacts* const> groups,
                            ilaw_coupled_options options = {}) {
    options.struct_size = sizeof options;
    ilaw_coupled_report report{};
    report.struct_size = sizeof report;
    const std::int32_t code = ilaw_coupled_solve(handle_.get(), &bodies, groups.data(),
                                                 static_cast<std::int64_t>(groups.size()), &options, &report);
    if (code < 0) throw error(code, report.reason ? report.reason : "coupled contacts were refused");
    return report;
  }

 private:
  struct destroyer {
    void operator()(ilaw_coupled* solver) const { ilaw_coupled_destroy(solver); }
  };
  std::unique_ptr<ilaw_coupled, destroyer> handle_;
};

}  // namespace ilaw

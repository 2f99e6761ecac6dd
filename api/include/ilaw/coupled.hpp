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

// The contacts of one law, whose interface was made for the global frame and this form of H.
inline ilaw_contacts contacts_of(const interface& law, ilaw_delassus_form form, const ilaw_batch& batch,
                                 const std::int32_t* body, const std::int32_t* counterpart) {
  ilaw_contacts made{};
  made.struct_size = sizeof made;
  made.delassus_form = form;
  made.law = &law.law();
  made.instance = law.instance();
  made.batch = &batch;
  made.body = body;
  made.counterpart = counterpart;
  return made;
}

// Thrown where a call is refused; its report names the contact, if it is one.
class coupled_error : public error {
 public:
  coupled_error(ilaw_result code, const ilaw_coupled_report& report)
      : error(code, report.reason ? report.reason : "coupled contacts were refused"), report_(report) {}
  const ilaw_coupled_report& report() const { return report_; }

 private:
  ilaw_coupled_report report_;
};

// Movable; one solve at a time.
class coupled {
 public:
  coupled() : handle_(ilaw_coupled_create()) {
    if (!handle_) throw std::bad_alloc();
  }

  // Throws coupled_error where the call is refused. Contacts with bad input are no exception:
  // report.bad_count.
  ilaw_coupled_report solve(const ilaw_bodies& bodies, std::span<const ilaw_contacts* const> groups,
                            ilaw_coupled_options options = {}) {
    options.struct_size = sizeof options;
    ilaw_coupled_report report{};
    report.struct_size = sizeof report;
    const std::int32_t code = ilaw_coupled_solve(handle_.get(), &bodies, groups.data(),
                                                 static_cast<std::int64_t>(groups.size()), &options, &report);
    if (code < 0) throw coupled_error(code, report);
    return report;
  }
  ilaw_coupled_report solve(const ilaw_bodies& bodies, const ilaw_contacts& group,
                            ilaw_coupled_options options = {}) {
    const ilaw_contacts* groups[] = {&group};
    return solve(bodies, groups, options);
  }

 private:
  struct destroyer {
    void operator()(ilaw_coupled* solver) const { ilaw_coupled_destroy(solver); }
  };
  std::unique_ptr<ilaw_coupled, destroyer> handle_;
};

}  // namespace ilaw

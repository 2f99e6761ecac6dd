// format.h - what LAMMPS' headers name of the fmt library that is built into LAMMPS. Debian's liblammps-dev
// ships them without it, and its own libfmt is another version. Nothing here is ever called: errors are
// raised with a std::string.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fmt {

class string_view;
class format_args;
template <class... Arguments, class Format>
format_args make_args_checked(const Format& format, Arguments&... arguments);

}  // namespace fmt

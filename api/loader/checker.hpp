// checker.hpp - refuses what a library says wrong of itself, with the path to the culprit in every message,
// e.g. "contact.so: law 'contact': parameter 'restitution': ...". Nothing is read before it is known to be
// readable.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "readable.hpp"
#include "refusal.hpp"

#include <ilaw/sized.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace ilaw::loading {

// Memory of copies of a description, and what was read to make them.
class storage {
 public:
  void* room(std::size_t bytes) {
    rooms_.push_back(std::make_unique<std::max_align_t[]>(bytes / sizeof(std::max_align_t) + 1));
    return rooms_.back().get();
  }

  void remember(const void* at, std::size_t bytes) {
    read_.push_back({static_cast<const char*>(at), std::string(static_cast<const char*>(at), bytes), false});
  }
  void remember(const char* text) { read_.push_back({text, text, true}); }
  // Whether all that was read is still there. Each address stands in what was read before it, so that a
  // library that frees and reuses its memory is followed, too.
  bool is_unchanged() const {
    return std::all_of(read_.begin(), read_.end(), [](const part& one) {
      return one.is_text ? one.bytes == one.at : std::memcmp(one.at, one.bytes.data(), one.bytes.size()) == 0;
    });
  }

 private:
  struct part {
    const char* at;
    std::string bytes;
    bool is_text;
  };

  std::vector<std::unique_ptr<std::max_align_t[]>> rooms_;
  std::vector<part> read_;
};

class checker {
 public:
  // newer: a library of a newer minor version than the loader may have bits and kinds that it does not know.
  checker(std::string where, bool newer, storage& kept)
      : where_(std::move(where)), newer_(newer), kept_(kept) {}

  checker inside(const std::string& what) const { return {where_ + ": " + what, newer_, kept_}; }

  [[noreturn]] void refuse(const std::string& found_and_expected) const {
    throw refusal(ILAW_BAD_LIBRARY, where_ + ": " + found_and_expected);
  }

  // A copy of a struct that is at least as large as this version's, with zeros where its writer had no
  // member.
  template <class Struct>
  Struct& copy(const Struct* given, const char* what) const {
    if (!given) refuse(std::string(what) + " is null");
    if (!readable(given, sizeof(std::uint32_t))) refuse_unreadable(what);
    const std::uint32_t size = sized::size_of(given);
    if (!sized::is_plausible<Struct>(size))
      refuse(std::string(what) + " has struct_size " + std::to_string(size) + ", expected at least " +
             std::to_string(sized::least<Struct>) + " and at most " + std::to_string(sized::most));
    if (!readable(given, size)) refuse_unreadable(what);
    kept_.remember(given, sizeof size);
    kept_.remember(given, size);
    const std::size_t room = std::max<std::size_t>(size, sizeof(Struct));
    auto* made = static_cast<Struct*>(kept_.room(room));
    sized::copy(made, room, given, size);
    made->struct_size = static_cast<std::uint32_t>(room);
    return *made;
  }

  // A copy of an array of count pointers.
  template <class Element>
  std::remove_const_t<Element>* array(Element* given, std::uint32_t count, const char* what) const {
    constexpr std::uint32_t most = 10000;  // far more than any library has
    if (count > most)
      refuse(std::string(what) + " has " + std::to_string(count) + " entries, expected at most " +
             std::to_string(most));
    const std::size_t bytes = count * sizeof(Element);
    auto* made = static_cast<std::remove_const_t<Element>*>(kept_.room(bytes));
    if (count == 0) return made;
    if (!given) refuse(std::string(what) + " is null, expected " + std::to_string(count) + " entries");
    if (!readable(given, bytes)) refuse_unreadable(what);
    kept_.remember(given, bytes);
    std::memcpy(made, given, bytes);
    return made;
  }

  void text(const char* t, const char* what) const { check_text(t, what, false); }
  // May have several lines.
  void prose(const char* t, const char* what) const { check_text(t, what, true); }
  void name(const char* n, const char* what) const;

  void texts(const char* const* list, std::uint32_t count, const char* what) const {
    for (std::uint32_t i = 0; i < count; ++i) text(list[i], what);
  }

  void mask(std::uint32_t value, std::uint32_t known, const char* what) const;
  // A mask of which a host chooses one entry.
  void choice_of(std::uint32_t value, std::uint32_t known, const char* what) const;
  // A member that a newer minor version may use.
  void zero(std::uint32_t value, const char* what) const;
  void kind(std::uint32_t value, std::uint32_t largest, const char* what) const;

 private:
  [[noreturn]] void refuse_unreadable(const char* what) const {
    refuse(std::string(what) + " points to memory that cannot be read");
  }
  void check_text(const char* t, const char* what, bool lines_allowed) const;

  std::string where_;
  bool newer_;
  storage& kept_;
};

}  // namespace ilaw::loading

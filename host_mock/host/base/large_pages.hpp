// large_pages.hpp - where large arrays lie in memory.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <malloc.h>
#include <sys/mman.h>

#include <cstddef>
#include <cstdint>

namespace ilaw::host {

// For all arrays that are made from now on: one after another. Large blocks each in pages of their own
// all begin at the same place of a page, and share few places of the caches.
inline void place_arrays_one_after_another() { mallopt(M_MMAP_MAX, 0); }

// Asks the system for pages of 2 MB, for an array that is filled. A pass over many arrays in small pages
// comes to a new page every few hundred nodes in each, and waits there for its address and first line.
// The system may refuse: nothing but time depends on it.
template <class Array>
void keep_in_large_pages(const Array& array) {
  constexpr std::uintptr_t page = 1 << 21;
  const auto start = reinterpret_cast<std::uintptr_t>(array.data());
  const std::uintptr_t first = (start + page - 1) / page * page,
                       end = (start + static_cast<std::size_t>(array.size()) * sizeof *array.data()) / page *
                             page;
  if (end <= first) return;
  void* const pages = reinterpret_cast<void*>(first);
  constexpr int collapse = 25;  // MADV_COLLAPSE, of Linux 6.1, which older headers do not know
  madvise(pages, end - first, MADV_HUGEPAGE);
  madvise(pages, end - first, collapse);
}

}  // namespace ilaw::host

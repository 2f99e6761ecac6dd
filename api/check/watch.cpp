// SPDX-License-Identifier: BSD-3-Clause
#include "check/watch.hpp"

#include "check/sandbox.hpp"

#include <cxxabi.h>
#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <memory>
#include <sstream>
#include <type_traits>
#include <utility>

namespace ilaw::check {
namespace {

// The functions of each kind, in the order of Forbidden; a '*' at its end stands for all that begin so.
constexpr std::array forbidden{
    "malloc calloc realloc free aligned_alloc posix_memalign memalign strdup mmap* _Znw* _Zna* "
    "_Zdl* _Zda* _ZNSt7__cxx1112basic_string*",
    "pthread_mutex_* pthread_rwlock_* pthread_spin_* pthread_cond_* pthread_once pthread_create "
    "sem_* mtx_* thrd_* __cxa_guard_acquire GOMP_* _ZNSt6thread*",
    "printf fprintf vfprintf __printf_chk __fprintf_chk puts putchar fputs fputc fwrite fread "
    "fgets fflush fopen* fclose open* read write perror syslog getenv setenv system "
    "_ZSt16__ostream_insert* _ZStlsISt11char_traits* _ZNSo*",
    "time clock clock_gettime gettimeofday timespec_get sleep usleep nanosleep _ZNSt6chrono* rand "
    "rand_r random* drand48* lrand48* getrandom arc4random*",
    "exit _exit abort raise kill signal sigaction _setjmp longjmp"};
constexpr std::size_t most_names = 32;
std::vector<std::string> watched;  // names of the kind that is watched

bool matches(const std::string& pattern, const std::string& name) {
  if (pattern.back() != '*') return pattern == name;
  return name.compare(0, pattern.size() - 1, pattern, 0, pattern.size() - 1) == 0;
}

// Replacement of a forbidden function. It never returns, so its arguments do not matter.
template <std::size_t K>
[[noreturn]] void called() {
  end_here("called ", watched[K].c_str());
}
template <std::size_t... K>
constexpr auto substitutes(std::index_sequence<K...>) {
  return std::array<void (*)(), sizeof...(K)>{called<K>...};
}
constexpr auto all_substitutes = substitutes(std::make_index_sequence<most_names>{});

// Entries of the dynamic section of a loaded file.
struct Dynamic {
  ElfW(Addr) base = 0;
  const ElfW(Sym) * symbols = nullptr;
  const char* strings = nullptr;
  const std::uint32_t *hash = nullptr, *gnu_hash = nullptr;
  const ElfW(Rela) * tables[2] = {nullptr, nullptr};
  std::size_t sizes[2] = {0, 0};
};

// The value of an entry, 0 without it.
ElfW(Addr) entry_of(const link_map& map, ElfW(Sxword) tag) {
  for (const ElfW(Dyn)* entry = map.l_ld; entry->d_tag != DT_NULL; ++entry)
    if (entry->d_tag == tag) return entry->d_un.d_ptr;
  return 0;
}

Dynamic dynamic_of(const link_map& map) {
  const auto place = [&](ElfW(Sxword) tag, auto& found) {
    const ElfW(Addr) address = entry_of(map, tag);
    // Some C libraries leave the addresses as they are in the file.
    const ElfW(Addr) offset = address < map.l_addr ? map.l_addr : 0;
    if (address) found = reinterpret_cast<std::decay_t<decltype(found)>>(address + offset);
  };
  Dynamic found;
  found.base = map.l_addr;
  place(DT_HASH, found.hash);
  place(DT_GNU_HASH, found.gnu_hash);
  place(DT_SYMTAB, found.symbols);
  place(DT_STRTAB, found.strings);
  place(DT_JMPREL, found.tables[0]);
  place(DT_RELA, found.tables[1]);
  found.sizes[0] = entry_of(map, DT_PLTRELSZ) / sizeof(ElfW(Rela));
  found.sizes[1] = entry_of(map, DT_RELASZ) / sizeof(ElfW(Rela));
  return found;
}

// One past the last symbol that a lookup finds: the last bucket in use begins the last chain, which a set
// lowest bit ends (GNU hash); DT_HASH has the number of symbols.
std::size_t symbol_count(const Dynamic& file) {
  if (!file.gnu_hash) return file.hash ? file.hash[1] : 0;
  const std::uint32_t buckets = file.gnu_hash[0], first = file.gnu_hash[1], bloom_size = file.gnu_hash[2];
  const std::uint32_t* const bucket = file.gnu_hash + 4 + bloom_size * (sizeof(ElfW(Addr)) / 4);
  const std::uint32_t* const chain = bucket + buckets;
  std::size_t last = *std::max_element(bucket, bucket + buckets);
  if (last < first) return first;
  while (!(chain[last - first] & 1U)) ++last;
  return last + 1;
}

// Calls look with the dynamic section of a loaded library; false if it has none.
bool with_dynamic(const std::string& library, const std::function<void(const Dynamic& file)>& look) {
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
  link_map* map = nullptr;
  const bool found = handle && dlinfo(handle, RTLD_DI_LINKMAP, &map) == 0 && map;
  if (found) look(dynamic_of(*map));
  if (handle) dlclose(handle);
  return found;
}

bool is_exported(const ElfW(Sym) & symbol) {
  const unsigned binding = ELF64_ST_BIND(symbol.st_info), visibility = ELF64_ST_VISIBILITY(symbol.st_other);
  return symbol.st_shndx != SHN_UNDEF && symbol.st_shndx != SHN_ABS && binding != STB_LOCAL &&
         (visibility == STV_DEFAULT || visibility == STV_PROTECTED);
}

bool is_of_linker(const std::string& name) {
  constexpr std::array names{"_init",         "_fini",       "_edata",     "_end",   "__bss_start",
                             "__bss_start__", "__bss_end__", "_bss_end__", "__end__"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string demangled(const char* name) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(abi::__cxa_demangle(name, nullptr, nullptr, &status),
                                                         &std::free);
  return text ? text.get() : name;
}

// Calls look for each place that holds the address of a function of another library, with its name.
void for_imports(const std::string& library,
                 const std::function<void(void** place, const char* name)>& look) {
  with_dynamic(library, [&](const Dynamic& file) {
    for (int t = 0; t < 2; ++t)
      for (std::size_t k = 0; file.tables[t] && k < file.sizes[t]; ++k) {
        const ElfW(Rela)& entry = file.tables[t][k];
        const std::size_t symbol = ELF64_R_SYM(entry.r_info);
        if (symbol == 0 || file.symbols[symbol].st_shndx != SHN_UNDEF) continue;
        look(reinterpret_cast<void**>(file.base + entry.r_offset),
             file.strings + file.symbols[symbol].st_name);
      }
  });
}

void make_writable(const void* place) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const std::size_t address = reinterpret_cast<std::size_t>(place) / page * page;
  mprotect(reinterpret_cast<void*>(address), page, PROT_READ | PROT_WRITE);
}

}  // namespace

std::optional<std::vector<Exported>> exported_symbols(const std::string& library) {
  std::optional<std::vector<Exported>> all;
  with_dynamic(library, [&](const Dynamic& file) {
    const std::size_t count = file.symbols && file.strings ? symbol_count(file) : 0;
    if (count > 0) all.emplace();
    for (std::size_t k = 1; k < count; ++k) {
      const ElfW(Sym)& symbol = file.symbols[k];
      const char* const name = file.strings + symbol.st_name;
      const unsigned binding = ELF64_ST_BIND(symbol.st_info);
      if (is_exported(symbol) && !is_of_linker(name))
        all->push_back({demangled(name), binding == STB_WEAK, binding == STB_GNU_UNIQUE});
    }
  });
  return all;
}

CallWatch::CallWatch(const std::string& library, Forbidden kind) {
  std::istringstream words(forbidden[static_cast<std::size_t>(kind)]);
  watched.assign(std::istream_iterator<std::string>(words), {});
  for_imports(library, [&](void** place, const char* name) {
    std::size_t k = 0;
    while (k < watched.size() && !matches(watched[k], name)) ++k;
    if (k == watched.size()) return;
    make_writable(place);
    slots_.push_back({place, *place});
    *place = reinterpret_cast<void*>(all_substitutes[k]);
  });
}

CallWatch::~CallWatch() {
  for (const Slot& slot : slots_) *slot.place = slot.value;
}

Globals::Globals(const std::string& library) {
  struct Search {
    std::string path;
    std::vector<Part>* parts;
  } search{library, &parts_};
  dl_iterate_phdr(
      [](dl_phdr_info* file, std::size_t, void* context) {
        const Search& wanted = *static_cast<Search*>(context);
        if (!file->dlpi_name || wanted.path != file->dlpi_name) return 0;
        for (int k = 0; k < file->dlpi_phnum; ++k) {
          const ElfW(Phdr)& part = file->dlpi_phdr[k];
          if (part.p_type != PT_LOAD || !(part.p_flags & PF_W)) continue;
          const char* begin = reinterpret_cast<const char*>(file->dlpi_addr + part.p_vaddr);
          wanted.parts->push_back({begin, std::vector<char>(begin, begin + part.p_memsz)});
        }
        return 1;
      },
      &search);
}

std::size_t Globals::changed() const {
  std::size_t bytes = 0;
  for (const Part& part : parts_)
    for (std::size_t k = 0; k < part.copy.size(); ++k) bytes += part.begin[k] != part.copy[k];
  return bytes;
}

bool forbid_system_calls() {
  const auto allow = [](unsigned number) {
    return std::array{sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, number, 0, 1),
                      sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  };
  const auto write = allow(SYS_write), end = allow(SYS_exit_group), back = allow(SYS_rt_sigreturn);
  std::array filter{sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                    write[0],
                    write[1],
                    end[0],
                    end[1],
                    back[0],
                    back[1],
                    sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP)};
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

}  // namespace ilaw::check

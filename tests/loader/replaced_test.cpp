// Libraries that are replaced, overwritten, truncated, moved and removed while they are open: random
// sequences of commands against a model. A library that opens speaks the version that its path has on the
// disk.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/loader.hpp>

#include "replaced_files.hpp"
#include "support/random.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <list>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

using namespace ilaw::testing::replaced_files;

// ---- commands -------------------------------------------------------------------------------------------

enum class Act {
  install,     // a new file takes the place
  write,       // the same file has other bytes
  copy,        // as cp does: truncates, then writes
  copy_again,  // and sets the time back
  truncate,
  remove,
  link,  // the other path becomes a second name of the file
  move,  // to the other path
  open,
  open_named,
  search,
  create,
  evaluate,
  describe,
  close,
  destroy,
  fork,     // a child opens the path, and the interfaces answer there as here
  threads,  // three at once open the path, ask the law and close it
  load,     // without the loader, as another part of the process does
  unload,
  expose,  // the folder: every user may write to it, or no longer
  count
};
constexpr std::array<const char*, static_cast<std::size_t>(Act::count)> act_names = {
    "install", "write",   "copy",       "copy_again", "truncate", "remove",   "link",
    "move",    "open",    "open_named", "search",     "create",   "evaluate", "describe",
    "close",   "destroy", "fork",       "threads",    "load",     "unload",   "expose"};
constexpr std::array<const char*, 2> file_names = {"left", "right"};

struct Command {
  Act act;
  int file;     // of file_names
  int version;  // 1 or 2
  int choice;   // of the handles or interfaces, modulo their number

  std::string text() const {
    return std::string(act_names.at(static_cast<std::size_t>(act))) + " " + std::to_string(version) + " " +
           file_names.at(static_cast<std::size_t>(file)) + " #" + std::to_string(choice);
  }
};

std::vector<Command> random_commands(std::uint64_t seed) {
  ilaw::testing::Random random(seed);
  std::vector<Command> commands;
  for (int k = 0; k < 40; ++k)
    commands.push_back({static_cast<Act>(random.below(static_cast<int>(Act::count))), random.below(2),
                        1 + random.below(2), random.below(1000)});
  return commands;
}

// ---- model ----------------------------------------------------------------------------------------------

struct Content {
  int version;     // 0: truncated
  int writes = 0;  // to it, in its place
  int names = 0;   // times that its names changed
};

struct OpenLibrary {
  ilaw_library* library;
  int file;
  std::shared_ptr<Content> content;
  Content then;          // when it was opened
  int users = 0;         // openings and interfaces
  bool is_torn = false;  // truncated while it is loaded: none of its code may run again

  bool was_written() const { return content->writes != then.writes; }
};

struct OpenInterface {
  ilaw_interface* interface;
  OpenLibrary* from;
};

class Machine {
 public:
  explicit Machine(fs::path folder) : folder_(std::move(folder)) {}

  void run(const Command& c) {
    has_other_names_ = has_other_names_ && !(libraries_.empty() && elsewhere_.empty());
    switch (c.act) {
      case Act::install:
        forget(c.file);
        install(path(c.file), c.version);
        content(c.file) = std::make_shared<Content>(Content{c.version});
        break;
      case Act::write:
        return rewrite(c, 0, false);
      case Act::copy:
        return rewrite(c, O_TRUNC, false);
      case Act::copy_again:
        return rewrite(c, O_TRUNC, true);
      case Act::truncate:
        if (!content(c.file) || has_other_names_) return;
        tear(c.file);
        fs::resize_file(path(c.file), bytes_of(1).size() / 2);
        write_over(path(c.file), "\x7f", 0);
        ++content(c.file)->writes;
        content(c.file)->version = 0;
        break;
      case Act::remove:
        forget(c.file);
        fs::remove(path(c.file));
        break;
      case Act::link:
        if (!content(c.file) || content(c.file) == content(1 - c.file)) return;
        forget(1 - c.file);
        fs::remove(path(1 - c.file));
        fs::create_hard_link(path(c.file), path(1 - c.file));
        content(1 - c.file) = content(c.file);
        ++content(c.file)->names;
        break;
      case Act::move:
        if (!content(c.file) || content(c.file) == content(1 - c.file)) return;
        forget(1 - c.file);
        fs::rename(path(c.file), path(1 - c.file));
        ++content(c.file)->names;
        content(1 - c.file) = std::move(content(c.file));
        break;
      case Act::open:
        return open_and_judge(c.file, path(c.file).string(), ilaw_library_open);
      case Act::open_named:
        return open_named(c.file);
      case Act::search:
        return search();
      case Act::create:
        return create(c.choice);
      case Act::evaluate:
        return evaluate(c.choice);
      case Act::describe:
        return describe(c.choice);
      case Act::close:
        return close_one(c.choice);
      case Act::destroy:
        return destroy_one(c.choice);
      case Act::fork:
        return fork_one(c);
      case Act::threads:
        return open_in_threads(c.file);
      case Act::load:
        return load_elsewhere(c.file);
      case Act::unload:
        if (!elsewhere_.empty()) elsewhere_.pop_back();
        break;
      case Act::expose:
        is_exposed_ = !is_exposed_;
        fs::permissions(folder_, is_exposed_ ? fs::perms::all : fs::perms::owner_all);
        break;
      case Act::count:
        break;
    }
  }

 private:
  fs::path path(int file) const {
    return folder_ / (std::string(file_names.at(static_cast<std::size_t>(file))) + ".so");
  }
  std::shared_ptr<Content>& content(int file) { return contents_.at(static_cast<std::size_t>(file)); }

  void forget(int file) {
    if (content(file)) ++content(file)->names;
    content(file).reset();
  }
  void tear(int file) {
    for (OpenLibrary& one : libraries_)
      if (one.content == content(file)) one.is_torn = true;
  }
  // Code that another part of the process runs stays as it is: nobody could tell that part.
  void rewrite(const Command& c, int flags, bool keeps_time) {
    if (has_other_names_) return;
    if (!content(c.file)) content(c.file) = std::make_shared<Content>();
    if (flags & O_TRUNC) tear(c.file);
    write_over(path(c.file), bytes_of(c.version), flags, keeps_time);
    ++content(c.file)->writes;
    content(c.file)->version = c.version;
  }

  struct Answer {
    ilaw_result code = ILAW_OK;
    ilaw_library* library = nullptr;
    std::string said;
  };
  using Open = ilaw_result(ILAW_CALL*)(const char*, ilaw_library**, char*, std::size_t);
  static Answer answer_of(const std::string& text, Open open) {
    Answer answer;
    std::array<char, 1024> message{};
    answer.code = open(text.c_str(), &answer.library, message.data(), message.size());
    answer.said = message.data();
    return answer;
  }

  void open_and_judge(int file, const std::string& text, Open open) {
    const Answer answer = answer_of(text, open);
    judge(file, answer);
    if (!answer.library) return;
    auto known = std::find_if(libraries_.begin(), libraries_.end(),
                              [&](const OpenLibrary& one) { return one.library == answer.library; });
    if (known == libraries_.end())
      known = libraries_.insert(known, {answer.library, file, content(file), *content(file)});
    else
      known->then.names = content(file)->names;
    must(known->content == content(file), "the object of another file");
    ++known->users;
    handles_.push_back(&*known);
    judge_title(*known);
  }

  void open_named(int file) {
    const char* const name = file_names.at(static_cast<std::size_t>(file));
    if (!is_exposed_) return open_and_judge(file, name, ilaw_library_open_named);
    const Answer answer = answer_of(name, ilaw_library_open_named);
    must(answer.code == ILAW_NOT_FOUND, "opened where every user may write: " + answer.said);
  }

  void load_elsewhere(int file) {
    if (!content(file) || content(file)->version == 0) return;
    for (const OpenLibrary& one : libraries_)
      if (!is_sound(one)) return;
    elsewhere_.emplace_back(dlopen(path(file).c_str(), RTLD_NOW | RTLD_LOCAL), dlclose);
    must(elsewhere_.back() != nullptr, "not loaded");
    has_other_names_ = true;
  }

  // glibc may go on with what others loaded by that path, until nobody has it.
  bool is_kept_elsewhere(const Answer& answer) const {
    return has_other_names_ && answer.code == ILAW_BAD_LIBRARY &&
           (answer.said.find(": changed since another part of this process loaded it: ") !=
                std::string::npos ||
            answer.said.ends_with(" as long as this process keeps it loaded"));
  }

  // Which refusal is right: one text, or none, or either where only the names of a file changed.
  void judge(int file, const Answer& answer) {
    const std::shared_ptr<Content>& on_disk = content(file);
    const auto& [code, library, said] = answer;
    must((code == ILAW_OK) == (library != nullptr), "code " + std::to_string(code) + ", " + said);
    if (!on_disk) return must(code == ILAW_NOT_FOUND, "no such file, but: " + said);
    if (is_kept_elsewhere(answer)) return;
    bool must_refuse = false, may_refuse = false, is_open = false;
    for (const OpenLibrary& one : libraries_) {
      const bool is_same = one.content == on_disk;
      must_refuse = must_refuse || (is_same ? one.was_written() : one.file == file);
      may_refuse = may_refuse || (is_same && on_disk->names != one.then.names);
      is_open = is_open || (is_same && !one.was_written());
    }
    must_refuse = must_refuse && !is_open;
    const std::string changed = path(file).string() + ": changed since it was opened: ";
    const bool is_refused = code == ILAW_BAD_LIBRARY && said.starts_with(changed) &&
                            said.ends_with(", expected the file of " + size_ +
                                           " bytes until its last handle and interface are closed");
    if (must_refuse) return must(is_refused, "opened, or refused for another reason: " + said);
    if (may_refuse && is_refused) return;
    if (on_disk->version == 0)
      return must(code == ILAW_BAD_LIBRARY && said.find(": truncated at ") != std::string::npos, said);
    must(code == ILAW_OK, "refused: " + said);
  }

  // The child has what this process has loaded, and may not disturb it.
  void fork_one(const Command& c) {
    must(fault_in_child([&] {
           open_and_judge(c.file, path(c.file).string(), ilaw_library_open);
           for (int k = 0; k < static_cast<int>(interfaces_.size()); ++k) evaluate(k);
           while (!handles_.empty() && !handles_.back()->is_torn)
             close_one(static_cast<int>(handles_.size()) - 1);
         }).empty(),
         "in a child");
  }

  // They agree with each other and with the disk, and leave nothing open.
  void open_in_threads(int file) {
    std::array<Answer, 3> answers;
    std::array<std::string, 3> titles;
    {
      std::vector<std::jthread> threads;
      for (std::size_t t = 0; t < answers.size(); ++t)
        threads.emplace_back([&, t] {
          answers.at(t) = answer_of(path(file).string(), ilaw_library_open);
          if (answers.at(t).library) titles.at(t) = ilaw_library_law(answers.at(t).library, "zero")->title;
        });
    }
    for (std::size_t t = 0; t < answers.size(); ++t) {
      judge(file, answers.at(t));
      must(answers.at(t).library == answers[0].library, "threads have several objects of one file");
      must(titles.at(t) == titles[0], "threads read " + titles[0] + " and " + titles.at(t));
    }
    if (!answers[0].library) return;
    must(titles[0] == "Number " + std::to_string(content(file)->version), "threads read " + titles[0]);
    std::vector<std::jthread> threads;
    for (const Answer& answer : answers)
      threads.emplace_back([library = answer.library] { ilaw_library_close(library); });
  }

  static void judge_title(const OpenLibrary& one) {
    const std::string title = ilaw_library_law(one.library, "zero")->title;
    must(title == "Number " + std::to_string(one.then.version), "says: " + title);
  }
  // Of code that other bytes took the place of, nothing is known.
  static bool is_sound(const OpenLibrary& one) { return !one.is_torn && !one.was_written(); }

  void describe(int choice) const {
    if (const OpenLibrary* one = chosen(handles_, choice); one && is_sound(*one)) judge_title(*one);
  }
  void search() const {
    std::set<std::string> found, expected;
    for (const std::string& file : ilaw::search())
      if (fs::path(file).parent_path() == folder_) found.insert(file);
    for (int file = 0; file < 2 && !is_exposed_; ++file)
      if (contents_.at(static_cast<std::size_t>(file))) expected.insert(path(file).string());
    must(found == expected, "search found " + std::to_string(found.size()) + " files");
  }
  void create(int choice) {
    OpenLibrary* one = chosen(handles_, choice);
    if (!one || !is_sound(*one)) return;
    ilaw_setup setup{};
    setup.struct_size = sizeof setup;
    setup.dimension = 1;
    setup.delassus_form = ILAW_DELASSUS_SCALAR;
    setup.frame = ILAW_FRAME_LOCAL;
    setup.numbers = ILAW_NUMBERS_DOUBLE;
    std::array<char, 1024> message{};
    ilaw_interface* made = nullptr;
    const ilaw_result code =
        ilaw_interface_create(one->library, nullptr, &setup, &made, message.data(), message.size());
    must(code == ILAW_OK, std::string("create: ") + message.data());
    ++one->users;
    interfaces_.push_back({made, one});
  }
  void evaluate(int choice) const {
    if (interfaces_.empty()) return;
    const OpenInterface& one = interfaces_[static_cast<std::size_t>(choice) % interfaces_.size()];
    if (!is_sound(*one.from)) return;
    double r = 7.0;
    ilaw_batch batch{};
    batch.struct_size = sizeof batch;
    batch.node_count = 1;
    batch.impulse = {&r, nullptr, 1, 1};
    must(ilaw_interface_evaluate(one.interface, &batch, nullptr) == ILAW_OK, "evaluate failed");
    must(r == one.from->then.version, "gives an impulse of " + std::to_string(r));
  }
  void close_one(int choice) {
    OpenLibrary* one = chosen(handles_, choice);
    if (!one || one->is_torn) return;
    handles_.erase(std::find(handles_.begin(), handles_.end(), one));
    ilaw_library_close(one->library);
    give_back(*one);
  }
  void destroy_one(int choice) {
    if (interfaces_.empty()) return;
    const auto at = interfaces_.begin() + choice % static_cast<int>(interfaces_.size());
    const OpenInterface one = *at;
    if (one.from->is_torn) return;
    interfaces_.erase(at);
    ilaw_interface_destroy(one.interface);
    give_back(*one.from);
  }
  void give_back(OpenLibrary& one) {
    if (--one.users == 0) libraries_.remove_if([&one](const OpenLibrary& other) { return &other == &one; });
  }
  static OpenLibrary* chosen(const std::vector<OpenLibrary*>& all, int choice) {
    return all.empty() ? nullptr : all[static_cast<std::size_t>(choice) % all.size()];
  }

  fs::path folder_;
  const std::string size_ = std::to_string(bytes_of(1).size());
  std::array<std::shared_ptr<Content>, 2> contents_;
  std::list<OpenLibrary> libraries_;
  std::vector<OpenLibrary*> handles_;  // once per opening
  std::vector<OpenInterface> interfaces_;
  std::vector<std::unique_ptr<void, int (*)(void*)>> elsewhere_;
  bool has_other_names_ = false, is_exposed_ = false;
};

// ---- runs -----------------------------------------------------------------------------------------------

// What goes wrong, empty where all is well: in a process of its own, which may crash and leaves nothing
// loaded.
std::string fault_of(const std::vector<Command>& commands) {
  const TemporaryFolder folder;
  return fault_in_child([&] {
    setenv("ILAW_PATH", folder.path.c_str(), 1);
    Machine machine(fs::canonical(folder.path));
    for (const Command& command : commands) machine.run(command);
  });
}

// Without all commands that the fault does not need.
std::vector<Command> shrunk(std::vector<Command> commands) {
  for (std::size_t at = commands.size(); at-- > 0;) {
    std::vector<Command> fewer = commands;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(at));
    if (fault_of(fewer).empty()) continue;
    commands.swap(fewer);
    at = commands.size();
  }
  return commands;
}

TEST(ReplacedLibrary, SpeaksWhatIsOnTheDiskOrIsRefused) {
  ASSERT_EQ(bytes_of(1).size(), bytes_of(2).size());
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const std::vector<Command> commands = random_commands(seed);
    if (fault_of(commands).empty()) continue;
    const std::vector<Command> least = shrunk(commands);
    std::string text;
    for (const Command& command : least) text += "\n  " + command.text();
    FAIL() << "seed " << seed << ": " << fault_of(least) << text;
  }
}

}  // namespace

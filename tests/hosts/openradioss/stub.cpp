// Starter and engine of OpenRadioss as a user library sees them: which functions they ask for, how they open
// it, and their cycle, for free nodes under constant forces.
//
//   stub LIBRARY start
//     reads window.txt, and model.txt, a line per node: user kinematic mass x v force
//   stub LIBRARY run CYCLES STEP [threads] [no_sync] [no_window]
//     goes on from its restart file. Columns of each cycle: time, work of the window before it, x, v.
//     threads: each call comes from another one. no_...: a deck that lacks one of the two
//
// SPDX-License-Identifier: BSD-3-Clause
#include <dlfcn.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

extern "C" void set_user_window_nodes_(const int* nodes, const int* count) {
  if (*count != 1) std::exit((std::fprintf(stderr, "%d nodes from %d on\n", *count, nodes[0]), 1));
}

namespace {

using Numbers = std::vector<double>;
using Integers = std::vector<int>;

struct Model {
  int cycle = 0;
  double time = 0.0, last_step = 0.0, work = 0.0;
  Integers user, kinematic, text;
  Numbers mass, x, v, d, force, memory;
};

template <class Value>
void keep(std::fstream& file, bool writes, std::vector<Value>& values) {
  std::size_t size = values.size();
  char* const bytes = reinterpret_cast<char*>(&size);
  writes ? void(file.write(bytes, sizeof size)) : void(file.read(bytes, sizeof size));
  values.resize(size);
  const auto length = static_cast<std::streamsize>(size * sizeof(Value));
  char* const data = reinterpret_cast<char*>(values.data());
  writes ? void(file.write(data, length)) : void(file.read(data, length));
}

void restart_file(Model& model, bool writes) {
  std::fstream file("restart", std::ios::binary | (writes ? std::ios::out : std::ios::in));
  Numbers scalars = {static_cast<double>(model.cycle), model.time, model.last_step, model.work};
  keep(file, writes, scalars);
  for (Integers* values : {&model.user, &model.kinematic, &model.text}) keep(file, writes, *values);
  for (Numbers* values : {&model.mass, &model.x, &model.v, &model.d, &model.force, &model.memory})
    keep(file, writes, *values);
  model.cycle = static_cast<int>(scalars[0]);
  model.time = scalars[1];
  model.last_step = scalars[2];
  model.work = scalars[3];
}

Model read_model() {
  Model model;
  std::ifstream file("model.txt");
  for (int user = 0, kinematic = 0; file >> user >> kinematic;) {
    Numbers row(10);
    for (double& number : row) file >> number;
    model.user.push_back(user);
    model.kinematic.push_back(kinematic);
    model.mass.push_back(row[0]);
    model.x.insert(model.x.end(), row.begin() + 1, row.begin() + 4);
    model.v.insert(model.v.end(), row.begin() + 4, row.begin() + 7);
    model.force.insert(model.force.end(), row.begin() + 7, row.end());
  }
  model.d.resize(model.x.size());
  return model;
}

class Library {
 public:
  explicit Library(const char* path) : handle_(dlopen(path, RTLD_LAZY | RTLD_GLOBAL | RTLD_DEEPBIND)) {
    if (!handle_) std::exit((std::fprintf(stderr, "%s\n", dlerror()), 1));
  }
  template <class Function>
  Function function(const std::string& name) const {
    void* const found = dlsym(handle_, name.c_str());
    if (!found) std::exit((std::fprintf(stderr, "%s is missing\n", name.c_str()), 1));
    return reinterpret_cast<Function>(found);
  }
  void must_have(const std::string& prefix, std::initializer_list<const char*> names) const {
    for (const char* name : names) function<void (*)()>(prefix + name + "_");
  }

 private:
  void* handle_;
};

const char root[] = "STUB";
const int root_length = 4;

void start(const Library& library) {
  library.must_have("st_", {"lecg", "lecguser", "lecm", "lecr", "lecm99", "lecsen", "riniuser", "siniusr",
                            "get_userbuf_var"});
  const auto sizes =
      library.function<void (*)(const char*, const int*, int*, const int*, const int*, const double*,
                                const double*, const double*, const double*, const double*, int*, int*)>(
          "st_userwis_ini_");
  const auto fill = library.function<void (*)(const char*, const int*, const int*, const int*, const double*,
                                              const double*, const double*, const double*, const double*,
                                              const int*, const int*, double*, int*)>("st_userwis_");
  Model model = read_model();
  {
    std::ifstream lines("window.txt");
    std::ofstream("SISTUB_0001.scr") << "/USERWI\n" + std::string(std::istreambuf_iterator<char>(lines), {});
  }
  const Numbers spin(model.x.size()), inertia(model.mass.size());
  const int count = static_cast<int>(model.user.size());
  int parameters[100] = {}, numbers = 0, integers = 0;
  sizes(root, &root_length, parameters, &count, model.user.data(), model.x.data(), model.v.data(),
        spin.data(), model.mass.data(), inertia.data(), &numbers, &integers);
  model.memory.resize(static_cast<std::size_t>(numbers));
  model.text.resize(static_cast<std::size_t>(integers) + 100);
  fill(root, &root_length, &count, model.user.data(), model.x.data(), model.v.data(), spin.data(),
       model.mass.data(), inertia.data(), &numbers, &integers, model.memory.data(), model.text.data());
  restart_file(model, true);
}

class Engine {
 public:
  Engine(const Library& library, bool threads, bool has_sync, bool has_window)
      : window_(library.function<Window>("eng_userwi_")),
        sync_(library.function<Sync>("ilaw_openradioss_sync")),
        threads_(threads),
        has_sync_(has_sync),
        has_window_(has_window) {
    library.must_have("eng_", {"ruser", "sigeps", "sigepsc", "flaw", "flawc", "suser", "userint",
                               "get_uintbuf_var", "user_sens", "get_lawc_user_var", "sigeps99c",
                               "set_lawc_user_var", "get_law_user_var", "sigeps99", "set_law_user_var"});
    restart_file(model_, false);
  }

  void run(int cycles, double length) {
    const double part[] = {1.0, 0.9, 0.8, 0.9};  // steps vary
    sync(model_.last_step);                      // as the engine does before its first cycle
    for (int i = 0; i < cycles; ++i) {
      window();
      advance(part[model_.cycle % 4] * length);
      print();
    }
    restart_file(model_, true);
  }

 private:
  using Window = void (*)(const char*, const int*, const int*, const int*, const int*, const int*, const int*,
                          const int*, const int*, const double*, const double*, double*, double*, double*,
                          double*, const double*, const double*, const double*, const double*, const double*,
                          const double*, const double*, const double*, double*, double*, double*);
  using Sync = void (*)(double, double, long, const int*, const int*, double*, double*, double*,
                        const double*);

  void call(const std::function<void()>& function) const {
    if (!threads_) return function();
    std::thread(function).join();
  }
  void sync(double step) {
    if (!has_sync_) return;
    call([&] {
      sync_(model_.time, step, static_cast<long>(model_.user.size()), model_.user.data(),
            model_.kinematic.data(), model_.x.data(), model_.v.data(), model_.d.data(), model_.mass.data());
    });
  }
  // With the first node of the window, in copies of its values.
  void window() {
    if (!has_window_) return;
    const int size = static_cast<int>(model_.memory.size()), integers = 0, one = 1, user = model_.user[0];
    double bound = 1e30, real = 0.0;
    Numbers a(3), moment(3), all(model_.x.size()), zero(3), x(model_.x.begin(), model_.x.begin() + 3),
        v(model_.v.begin(), model_.v.begin() + 3);
    call([&] {
      window_(root, &root_length, &size, &integers, &one, &model_.cycle, &one, model_.text.data(), &user,
              &model_.time, &model_.last_step, &bound, &real, &model_.work, model_.memory.data(), zero.data(),
              x.data(), v.data(), zero.data(), model_.mass.data(), zero.data(), zero.data(), zero.data(),
              a.data(), moment.data(), all.data());
    });
  }
  void advance(double step) {
    for (std::size_t i = 0; i < model_.x.size(); ++i) {
      model_.v[i] += 0.5 * (model_.last_step + step) * model_.force[i] / model_.mass[i / 3];
      model_.x[i] += step * model_.v[i];
      model_.d[i] += step * model_.v[i];
    }
    model_.time += step;
    model_.last_step = step;
    ++model_.cycle;
    sync(step);
  }
  void print() const {
    std::printf("%.17g %.17g", model_.time, model_.work);
    for (const Numbers* values : {&model_.x, &model_.v})
      for (const double value : *values) std::printf(" %.17g", value);
    std::printf("\n");
  }

  Window window_;
  Sync sync_;
  bool threads_, has_sync_, has_window_;
  Model model_;
};

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  const auto has = [&](const char* word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  if (words.size() < 2) return 1;
  const Library library(arguments[1]);
  int version = 0;
  library.function<void (*)(int*)>("userlib_id")(&version);
  if (version != 1) return 1;
  if (words[1] == "start")
    start(library);
  else
    Engine(library, has("threads"), !has("no_sync"), !has("no_window"))
        .run(std::atoi(words[2].c_str()), std::atof(words[3].c_str()));
}

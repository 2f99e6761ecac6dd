// Iterations and seconds that coupled contacts take to a residual of 1e-4 and of 1e-8, on problems in files.
//
// Usage: ilaw_bench_coupled_convergence [--limit SECONDS] FILE...
// A file is a text as Siconos writes it (FrictionContactProblem): the dimension 3, the number of contacts,
// the matrix W as dense (0) or in sparse 3 x 3 blocks (1), velocities without impulses q, coefficients of
// friction. W is made symmetric and scaled to a mean diagonal of 1. The residual is that of Siconos: the
// natural map over |q|. The solver knows bodies, so W is factored into B B', and a column of three is a body
// that gives way alike in all directions; rows of B are the weights of a contact.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw/arrays.hpp>
#include <ilaw/coupled.hpp>
#include <ilaw/loader.hpp>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace {

using Row = std::map<int, double>;

double cpu_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Problem {
  int contacts = 0;
  std::vector<Row> w;  // by row
  std::vector<double> q, friction;
};

template <class T>
std::vector<T> numbers(std::istream& file, std::size_t count) {
  std::vector<T> read(count);
  for (T& number : read) file >> number;
  return read;
}

void read_dense(std::istream& file, Problem& problem) {
  int rows = 0, columns = 0;
  file >> rows >> columns;
  for (int column = 0; column < columns; ++column)
    for (int row = 0; row < rows; ++row) {
      double value = 0.0;
      file >> value;
      if (value != 0.0) problem.w[static_cast<std::size_t>(row)][column] = value;
    }
}

void read_blocks(std::istream& file, Problem& problem) {
  std::size_t blocks = 0, rows = 0, columns = 0, starts = 0, indices = 0;
  file >> blocks >> rows >> columns;
  numbers<int>(file, rows + columns);
  file >> starts >> indices;
  const auto start = numbers<std::size_t>(file, starts);
  const auto index = numbers<int>(file, indices);
  for (std::size_t row = 0; row + 1 < starts; ++row)
    for (std::size_t k = start[row]; k < start[row + 1]; ++k) {
      int number = 0;
      file >> number;
      const auto values = numbers<double>(file, 9);
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t r = 0; r < 3; ++r)
          problem.w[3 * row + r][3 * index[k] + static_cast<int>(c)] = values[3 * c + r];
    }
}

void symmetrize_and_scale(Problem& problem) {
  double trace = 0.0;
  std::vector<Row> whole(problem.w.size());
  for (std::size_t i = 0; i < problem.w.size(); ++i)
    for (const auto& [j, value] : problem.w[i]) {
      whole[i][j] += 0.5 * value;
      whole[static_cast<std::size_t>(j)][static_cast<int>(i)] += 0.5 * value;
      if (static_cast<int>(i) == j) trace += value;
    }
  for (Row& row : whole)
    for (auto& [j, value] : row) value *= static_cast<double>(problem.w.size()) / trace;
  problem.w = std::move(whole);
}

bool read(const char* name, Problem& problem) {
  std::ifstream file(name);
  int dimension = 0, storage = -1, rows = 0, columns = 0;
  file >> dimension >> problem.contacts >> storage >> rows >> columns;
  if (!file || dimension != 3 || problem.contacts < 1 || (storage != 0 && storage != 1)) return false;
  problem.w.resize(static_cast<std::size_t>(rows));
  storage == 0 ? read_dense(file, problem) : read_blocks(file, problem);
  problem.q = numbers<double>(file, static_cast<std::size_t>(rows));
  problem.friction = numbers<double>(file, static_cast<std::size_t>(problem.contacts));
  if (!file) return false;
  symmetrize_and_scale(problem);
  return true;
}

// Rows of B with W = B B', in an order of few entries. A pivot of zero, of a redundant contact, has no
// column.
std::vector<Row> factor(const Problem& problem) {
  constexpr double zero = 1e-13;
  const int n = problem.contacts;
  Eigen::SparseMatrix<double> pattern(n, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < problem.w.size(); ++i)
    for (const auto& [j, value] : problem.w[i]) entries.emplace_back(static_cast<int>(i) / 3, j / 3, 1.0);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Upper>(), order);
  std::vector<Row> rest = problem.w, b(problem.w.size());
  for (int place = 0; place < n; ++place)
    for (int c = 0; c < 3; ++c) {
      const int pivot = 3 * order.indices()[place] + c, column = 3 * place + c;
      const Row row = rest[static_cast<std::size_t>(pivot)];
      const auto diagonal = row.find(pivot);
      const double value = diagonal == row.end() ? 0.0 : diagonal->second;
      for (const auto& [i, entry] : row) {
        rest[static_cast<std::size_t>(i)].erase(pivot);
        if (!(value > zero)) continue;
        b[static_cast<std::size_t>(i)][column] = entry / std::sqrt(value);
        for (const auto& [j, other] : row)
          if (i != pivot && j != pivot) rest[static_cast<std::size_t>(i)][j] -= entry * other / value;
      }
      rest[static_cast<std::size_t>(pivot)].clear();
    }
  return b;
}

// W of several problems is neither symmetric nor positive semidefinite, by geometry in single precision,
// which no masses of bodies are: W becomes B B'. Returns the largest change over the largest entry.
double make_semidefinite(Problem& problem, const std::vector<Row>& b) {
  std::vector<Row> columns(b.size()), product(b.size());
  for (std::size_t i = 0; i < b.size(); ++i)
    for (const auto& [j, value] : b[i]) columns[static_cast<std::size_t>(j)][static_cast<int>(i)] = value;
  for (const Row& column : columns)
    for (const auto& [i, x] : column)
      for (const auto& [j, y] : column) product[static_cast<std::size_t>(i)][j] += x * y;
  double change = 0.0, most = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    for (const auto& [j, value] : product[i]) change = std::max(change, std::fabs(value - problem.w[i][j]));
    for (const auto& [j, value] : problem.w[i]) most = std::max(most, std::fabs(value));
  }
  problem.w = std::move(product);
  return change / most;
}

double natural_map(const Problem& problem, const std::vector<double>& r) {
  double square = 0.0, size = 0.0;
  for (int k = 0; k < problem.contacts; ++k) {
    std::array<double, 3> u{};
    const auto at = static_cast<std::size_t>(3 * k);
    for (std::size_t c = 0; c < 3; ++c) {
      u[c] = problem.q[at + c];
      size += u[c] * u[c];
      for (const auto& [j, value] : problem.w[at + c]) u[c] += value * r[static_cast<std::size_t>(j)];
    }
    const double mu = problem.friction[static_cast<std::size_t>(k)];
    const double x = r[at] - (u[0] + mu * std::hypot(u[1], u[2])), y = r[at + 1] - u[1], z = r[at + 2] - u[2];
    const double t = std::hypot(y, z);
    std::array<double, 3> p{x, y, z};  // projected to the cone of friction
    if (mu * t <= -x) {
      p = {};
    } else if (t > mu * x) {
      const double normal = (mu * t + x) / (mu * mu + 1.0);
      p = {normal, mu * normal * y / t, mu * normal * z / t};
    }
    for (std::size_t c = 0; c < 3; ++c) square += (r[at + c] - p[c]) * (r[at + c] - p[c]);
  }
  return std::sqrt(square / size);
}

class Benchmark {
 public:
  Benchmark(const Problem& problem, const std::vector<Row>& b, const ilaw::library& library);
  struct Solved {
    double seconds, residual;
    ilaw_coupled_report report;
  };
  Solved solve(double tolerance, std::uint32_t iterations);

 private:
  const Problem& problem_;
  ilaw::interface law_;
  ilaw::coupled solver_;
  std::uint32_t width_ = 1;
  std::vector<std::int32_t> body_, wall_;
  std::vector<double> weight_, still_, velocity_, against_, normal_, impulse_;
};

ilaw::interface friction_law(const Problem& problem, const ilaw::library& library) {
  const bool is_one = std::adjacent_find(problem.friction.begin(), problem.friction.end(),
                                         std::not_equal_to<>()) == problem.friction.end();
  ilaw_argument friction{};
  friction.struct_size = sizeof friction;
  friction.kind = is_one ? ILAW_VALUE_NUMBER : ILAW_VALUE_PER_NODE;
  friction.name = "friction";
  friction.number = problem.friction.front();
  const ilaw_argument* arguments[] = {&friction};
  ilaw_setup setup{};
  setup.struct_size = sizeof setup;
  setup.dimension = 3;
  setup.delassus_form = ILAW_DELASSUS_FULL;
  setup.frame = ILAW_FRAME_GLOBAL;
  setup.numbers = ILAW_NUMBERS_DOUBLE;
  setup.arguments = arguments;
  setup.argument_count = 1;
  return {library, "", setup};
}

Benchmark::Benchmark(const Problem& problem, const std::vector<Row>& b, const ilaw::library& library)
    : problem_(problem), law_(friction_law(problem, library)) {
  const auto count = static_cast<std::size_t>(problem.contacts);
  std::vector<std::map<int, std::array<double, 9>>> blocks(count);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t row = 0; row < 3; ++row)
      for (const auto& [column, value] : b[3 * k + row])
        blocks[k]
            .try_emplace(column / 3, std::array<double, 9>{})
            .first->second[3 * row + static_cast<std::size_t>(column % 3)] = value;
    width_ = std::max(width_, static_cast<std::uint32_t>(blocks[k].size()));
  }
  for (const auto& of_contact : blocks) {
    for (const auto& [body, block] : of_contact) {
      body_.push_back(body);
      weight_.insert(weight_.end(), block.begin(), block.end());
    }
    body_.resize((body_.size() + width_ - 1) / width_ * width_, -1);
    weight_.resize(9 * body_.size());
    normal_.insert(normal_.end(), {1.0, 0.0, 0.0});
  }
  wall_.assign(count, -1);
  still_.assign(3 * count, 0.0);
  velocity_ = impulse_ = still_;
  for (const double x : problem.q) against_.push_back(-x);
}

Benchmark::Solved Benchmark::solve(double tolerance, std::uint32_t iterations) {
  const double one = 1.0, gap = 0.0;
  std::fill(impulse_.begin(), impulse_.end(), 0.0);
  const ilaw_input friction = ilaw::input(problem_.friction.data(), 1, 0);
  ilaw_batch batch{};
  batch.struct_size = sizeof batch;
  batch.node_count = problem_.contacts;
  batch.time = batch.velocity_step = batch.position_step = 1.0;
  batch.gap = ilaw::input(&gap, 0, 0);
  batch.normal = ilaw::input(normal_.data(), 3, 1);
  batch.impulse = ilaw::output(impulse_.data(), 3, 1);
  batch.per_node_parameters = &friction;
  ilaw_bodies bodies{};
  bodies.struct_size = sizeof bodies;
  bodies.dimension = 3;
  bodies.count = bodies.owned_count = problem_.contacts;
  bodies.inverse_mass = ilaw::input(&one, 0, 0);
  bodies.v_free = bodies.v_previous = ilaw::input(still_.data(), 3, 1);
  bodies.velocity = ilaw::output(velocity_.data(), 3, 1);
  ilaw_contacts contacts = ilaw::contacts_of(law_, ILAW_DELASSUS_FULL, batch, body_.data(), wall_.data());
  contacts.wall_velocity = ilaw::input(against_.data(), 3, 1);
  contacts.wall_previous = ilaw::input(still_.data(), 3, 1);  // no velocity before: nothing bounces
  contacts.body_count = width_;
  contacts.body_weight = ilaw::input(weight_.data(), 9 * std::int64_t{width_}, 1);
  contacts.weight_size = 9;
  ilaw_coupled_options options{};
  options.tolerance = tolerance;
  options.most_sweeps = iterations;
  const double start = cpu_seconds();
  const ilaw_coupled_report report = solver_.solve(bodies, contacts, options);
  return {cpu_seconds() - start, natural_map(problem_, impulse_), report};
}

// Tolerances of the solver are tried from coarse to fine: its residual is another one than that of the table.
void print_row(const char* name, Problem& problem, const ilaw::library& library, double limit) {
  static const char* const methods[] = {"Gauss-Seidel", "conjugate", "Anderson", "Douglas-Rachford",
                                        "Newton"};
  const std::vector<Row> b = factor(problem);
  const double changed = make_semidefinite(problem, b);
  Benchmark benchmark(problem, b, library);
  std::printf("%-36s %6d %8.1e", name, problem.contacts, changed);
  const double per_iteration = benchmark.solve(1e-300, 50).seconds / 50.0;
  const auto most = static_cast<std::uint32_t>(std::min(1e6, 1.0 + limit / per_iteration));
  double least = 1e300, tolerance = 1e-3;
  const char* method = "";
  for (const double target : {1e-4, 1e-8}) {
    bool reached = false;
    for (double spent = 0.0; !reached && tolerance > 1e-15 && spent < limit; tolerance *= 0.1) {
      const Benchmark::Solved solved = benchmark.solve(tolerance, most);
      least = std::min(least, solved.residual);
      method = methods[solved.report.method];
      spent = solved.seconds;
      if (!(solved.residual < target) || solved.seconds > limit) continue;
      reached = true;
      std::printf(" %8u %9.4f", solved.report.sweeps, solved.seconds);
    }
    if (!reached) std::printf(" %8s %9s", "-", "-");
  }
  std::printf(" %9.1e  %s\n", least, method);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  double limit = 3.0;
  int first = 1;
  if (argc > 2 && std::strcmp(argv[1], "--limit") == 0) {
    limit = std::atof(argv[2]);
    first = 3;
  }
  if (first >= argc) {
    std::fprintf(stderr, "usage: ilaw_bench_coupled_convergence [--limit SECONDS] FILE...\n");
    return 2;
  }
  const ilaw::library library("coulomb");
  std::printf("%-36s %6s %8s %8s %9s %8s %9s %9s  %s\n", "problem", "count", "W by", "to 1e-4", "s",
              "to 1e-8", "s", "residual", "method");
  for (int i = first; i < argc; ++i) {
    Problem problem;
    if (!read(argv[i], problem)) {
      std::fprintf(stderr, "%s: not a problem of contacts in dimension 3\n", argv[i]);
      return 1;
    }
    const std::string name = argv[i];
    print_row(name.substr(name.rfind('/') + 1).c_str(), problem, library, limit);
  }
  return 0;
}

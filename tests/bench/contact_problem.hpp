// contact_problem.hpp - problems of frictional contact in files of Siconos (text) and FCLIB (HDF5), W as
// bodies have it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#ifdef ILAW_FCLIB
extern "C" {
#include <fclib.h>
}
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

using Row = std::map<int, double>;

inline double cpu_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Processor time of a call, the mean of as many as take 30 ms together: the clock of some systems is coarse.
template <class Call>
double mean_seconds(Call&& call) {
  const double start = cpu_seconds();
  int calls = 0;
  double spent = 0.0;
  for (; calls < 10000 && spent < 0.03; spent = cpu_seconds() - start, ++calls) call();
  return spent / calls;
}

struct Problem {
  int contacts = 0;
  std::vector<Row> w;  // by row
  std::vector<double> q, friction;
  double asymmetry = 0.0;  // largest |W - W'| over the largest entry of the file
};

template <class T>
std::vector<T> numbers(std::istream& file, std::size_t count) {
  std::vector<T> read(count);
  for (T& number : read) file >> number;
  return read;
}

inline void read_dense(std::istream& file, Problem& problem) {
  int rows = 0, columns = 0;
  file >> rows >> columns;
  for (int column = 0; column < columns; ++column)
    for (int row = 0; row < rows; ++row) {
      double value = 0.0;
      file >> value;
      if (value != 0.0) problem.w[static_cast<std::size_t>(row)][column] = value;
    }
}

inline void read_blocks(std::istream& file, Problem& problem) {
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

inline void symmetrize_and_scale(Problem& problem) {
  double trace = 0.0;
  std::vector<Row> whole(problem.w.size());
  for (std::size_t i = 0; i < problem.w.size(); ++i)
    for (const auto& [j, value] : problem.w[i]) {
      whole[i][j] += 0.5 * value;
      whole[static_cast<std::size_t>(j)][static_cast<int>(i)] += 0.5 * value;
      if (static_cast<int>(i) == j) trace += value;
    }
  double most = 0.0;
  for (std::size_t i = 0; i < problem.w.size(); ++i)
    for (const auto& [j, value] : problem.w[i]) {
      most = std::max(most, std::fabs(value));
      problem.asymmetry = std::max(problem.asymmetry, 2.0 * std::fabs(value - whole[i][j]));
    }
  problem.asymmetry /= most;
  for (Row& row : whole)
    for (auto& [j, value] : row) value *= static_cast<double>(problem.w.size()) / trace;
  problem.w = std::move(whole);
}

#ifdef ILAW_FCLIB
// The group fclib_local of an HDF5 file; problems of fclib_global have no W.
inline bool read_fclib(const char* name, Problem& problem) {
  fclib_local* local = fclib_read_local(name);
  if (local == nullptr) return false;
  const fclib_matrix& w = *local->W;
  const bool is_read = local->spacedim == 3 && local->V == nullptr && w.m > 0 && w.m % 3 == 0;
  if (is_read) {
    const auto rows = static_cast<std::size_t>(w.m);
    problem.contacts = w.m / 3;
    problem.w.resize(rows);
    // nz: -1 columns, -2 rows, else the number of triplets.
    for (int k = 0; w.nz >= 0 && k < w.nz; ++k) problem.w[static_cast<std::size_t>(w.i[k])][w.p[k]] += w.x[k];
    const int lines = w.nz == -1 ? w.n : w.m;
    for (int line = 0; w.nz < 0 && line < lines; ++line)
      for (int k = w.p[line]; k < w.p[line + 1]; ++k)
        (w.nz == -1 ? problem.w[static_cast<std::size_t>(w.i[k])][line]
                    : problem.w[static_cast<std::size_t>(line)][w.i[k]]) += w.x[k];
    problem.q.assign(local->q, local->q + rows);
    problem.friction.assign(local->mu, local->mu + rows / 3);
    symmetrize_and_scale(problem);
  }
  fclib_delete_local(local);
  std::free(local);
  return is_read;
}
#endif

inline bool read(const char* name, Problem& problem) {
  if (std::string(name).ends_with(".hdf5")) {
#ifdef ILAW_FCLIB
    return read_fclib(name, problem);
#else
    std::fprintf(stderr, "%s: read by libfclib, without which this program was built\n", name);
    return false;
#endif
  }
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
inline std::vector<Row> factor(const Problem& problem) {
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
inline double make_semidefinite(Problem& problem, const std::vector<Row>& b) {
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

inline double natural_map(const Problem& problem, const std::vector<double>& r) {
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

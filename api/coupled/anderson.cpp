// SPDX-License-Identifier: BSD-3-Clause
#include "anderson.hpp"

#include <algorithm>
#include <cmath>

namespace ilaw::coupled {
namespace {

// Added to the scaled normal equations, so that columns that depend on each other get small parts.
constexpr double regularisation = 1e-13;

double dot(const std::vector<double>& a, const std::vector<double>& b, std::size_t size) {
  std::array<double, 4> sum{};
  std::size_t i = 0;
  for (; i + 4 <= size; i += 4)
    for (std::size_t l = 0; l < 4; ++l) sum[l] += a[i + l] * b[i + l];
  for (; i < size; ++i) sum[0] += a[i] * b[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

}  // namespace

void Anderson::reset(std::size_t size, std::size_t depth, double slack) {
  size_ = size;
  depth_ = std::min(depth, max_depth);
  slack_ = slack;
  for (auto* vectors : {&last_image_, &last_residual_})
    if (vectors->size() < size) vectors->resize(size);
  for (std::size_t i = 0; i < depth_; ++i)
    for (auto* vectors : {&images_[i], &residuals_[i]})
      if (vectors->size() < size) vectors->resize(size);
  forget();
}

void Anderson::forget() {
  stored_ = next_ = 0;
  least_ = std::numeric_limits<double>::infinity();
  has_last_ = false;
}

void Anderson::store(const std::vector<double>& image, const std::vector<double>& residual) {
  std::vector<double>&of_images = images_[next_], &of_residuals = residuals_[next_];
  for (std::size_t i = 0; i < size_; ++i) {
    of_images[i] = image[i] - last_image_[i];
    of_residuals[i] = residual[i] - last_residual_[i];
  }
}

bool Anderson::correct(const std::vector<double>& image, const std::vector<double>& residual, const Sum& sum,
                       std::vector<double>& correction) {
  std::array<double, 2 * max_depth + 1> sums{};
  const bool grows = has_last_;
  const std::size_t newest = next_;
  if (grows) {
    store(image, residual);
    stored_ = std::min(stored_ + 1, depth_);
  }
  for (std::size_t i = 0; i < stored_; ++i) {
    if (grows) sums[i] = dot(residuals_[i], residuals_[newest], size_);
    sums[max_depth + i] = dot(residuals_[i], residual, size_);
  }
  sums[2 * max_depth] = dot(residual, residual, size_);
  sum(sums.data(), sums.size());
  for (std::size_t i = 0; i < stored_ && grows; ++i) products_[i][newest] = products_[newest][i] = sums[i];
  if (grows) next_ = (next_ + 1) % depth_;

  const double square = sums[2 * max_depth];
  if (square > slack_ * least_) forget();
  least_ = std::min(least_, square);
  std::copy_n(image.begin(), size_, last_image_.begin());
  std::copy_n(residual.begin(), size_, last_residual_.begin());
  has_last_ = true;
  if (stored_ == 0) return false;
  std::array<double, max_depth> parts{};
  std::copy_n(sums.begin() + max_depth, stored_, parts.begin());
  if (!solve(parts)) return false;
  for (std::size_t i = 0; i < size_; ++i) correction[i] = 0.0;
  for (std::size_t k = 0; k < stored_; ++k)
    for (std::size_t i = 0; i < size_; ++i) correction[i] -= parts[k] * images_[k][i];
  return true;
}

// Gaussian elimination with pivots, of the products scaled to a diagonal of 1.
bool Anderson::solve(std::array<double, max_depth>& right) const {
  const std::size_t m = stored_;
  std::array<double, max_depth> scale{};
  std::array<std::array<double, max_depth>, max_depth> matrix{};
  for (std::size_t i = 0; i < m; ++i) scale[i] = 1.0 / std::sqrt(products_[i][i] + 1e-300);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j) matrix[i][j] = products_[i][j] * scale[i] * scale[j];
    matrix[i][i] += regularisation;
    right[i] *= scale[i];
  }
  for (std::size_t i = 0; i < m; ++i) {
    std::size_t pivot = i;
    for (std::size_t k = i + 1; k < m; ++k)
      if (std::fabs(matrix[k][i]) > std::fabs(matrix[pivot][i])) pivot = k;
    std::swap(matrix[i], matrix[pivot]);
    std::swap(right[i], right[pivot]);
    for (std::size_t k = i + 1; k < m; ++k) {
      const double factor = matrix[k][i] / matrix[i][i];
      for (std::size_t c = i; c < m; ++c) matrix[k][c] -= factor * matrix[i][c];
      right[k] -= factor * right[i];
    }
  }
  bool is_finite = true;
  for (std::size_t i = m; i-- > 0;) {
    for (std::size_t c = i + 1; c < m; ++c) right[i] -= matrix[i][c] * right[c];
    right[i] /= matrix[i][i];
    is_finite = is_finite && std::isfinite(right[i]);
  }
  for (std::size_t i = 0; i < m; ++i) right[i] *= scale[i];
  return is_finite;
}

}  // namespace ilaw::coupled

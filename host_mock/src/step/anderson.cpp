// SPDX-License-Identifier: BSD-3-Clause
#include "step/anderson.hpp"

#include <Eigen/QR>

#include <algorithm>

namespace ilaw::host {

Dofs Anderson::correction(const Dofs& image, const Dofs& residual) {
  const double size = residual.squaredNorm();
  if (size > least_) *this = {};
  if (image_.size() > 0) {
    images_.push_back(image - image_);
    residuals_.push_back(residual - residual_);
  }
  if (images_.size() > depth) {
    images_.pop_front();
    residuals_.pop_front();
  }
  least_ = std::min(least_, size);
  image_ = image;
  residual_ = residual;
  Dofs correction = Dofs::Zero(image.size());
  if (images_.empty()) return correction;

  Eigen::MatrixXd columns(residual.size(), static_cast<Eigen::Index>(residuals_.size()));
  for (std::size_t k = 0; k < residuals_.size(); ++k)
    columns.col(static_cast<Eigen::Index>(k)) = residuals_[k];
  const Eigen::VectorXd parts = columns.colPivHouseholderQr().solve(residual);
  for (std::size_t k = 0; k < images_.size(); ++k)
    correction -= parts[static_cast<Eigen::Index>(k)] * images_[k];
  return correction;
}

}  // namespace ilaw::host

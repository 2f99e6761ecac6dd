// anderson.hpp - Anderson acceleration of a fixed-point iteration x = G(x) (Anderson 1965; Walker
// and Ni, SIAM J. Numer. Anal. 49, 2011): from the last images, the combination that would leave
// the least residual if G were linear. It has the fixed points of G, and no others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/model.hpp"

#include <deque>

namespace ilaw::host {

class Anderson {
 public:
  // What to add to image = G(x), given residual = G(x) - x, for the next x. Zero at first, and
  // where the last one made the residual larger: from there on it learns anew.
  Dofs correction(const Dofs& image, const Dofs& residual);

 private:
  static constexpr std::size_t depth = 10;

  double least_ = std::numeric_limits<double>::infinity();  // squared norm of residuals so far
  Dofs image_, residual_;                                   // the last
  std::deque<Dofs> images_, residuals_;                     // differences of successive ones
};

}  // namespace ilaw::host

// A transverse H is h_N n n^T + h_T (I - n n^T). That laws give the same for it in any form and frame is for
// `ilaw check` (form-agreement, frame-indifference).
#include "support/law_batch.hpp"

namespace ilaw::testing {
namespace {

// An H that is refused as a full matrix is refused as two values, and the other way round; in 1D the second
// value is not read.
TEST(TransverseInertia, IsAcceptedWhereItIsPositiveDefinite) {
  const Parameters parameters{{{"friction", 0.3}}, {}};
  const double least = std::numeric_limits<double>::min();
  const auto code = [&](std::uint32_t form, std::uint32_t dimension, std::vector<double> h) {
    LawBatch node(make_law("coulomb", SetupBuilder(parameters, dimension, form)));
    node.v_free[0] = node.v_previous[0] = {-1.0, 0.5, 0.0};
    std::copy(h.begin(), h.end(), node.h[0].begin());
    return node.evaluate();
  };
  for (const auto& [n, t] : {std::pair{1.0, 1.0},
                             {2.0, 7.0},
                             {0.0, 1.0},
                             {1.0, 0.0},
                             {-1.0, 1.0},
                             {1.0, -1.0},
                             {least, least},
                             {0.5 * least, least},
                             {inf_value, 1.0},
                             {1.0, inf_value},
                             {nan_value, 1.0},
                             {1.0, nan_value},
                             {1.0, 0x1p41},
                             {1.0, 0x1p43},
                             {0x1p41, 1.0},
                             {0x1p43, 1.0},
                             {1e300, 1e299},
                             {1e300, 1.0}})
    for (const std::uint32_t dimension : {2U, 3U}) {
      const std::vector<double> full =
          dimension == 2 ? std::vector{n, t, 0.0} : std::vector{n, t, t, 0.0, 0.0, 0.0};
      EXPECT_EQ(code(ILAW_DELASSUS_TRANSVERSE, dimension, {n, t}), code(ILAW_DELASSUS_FULL, dimension, full))
          << n << " " << t << ", " << dimension << "D";
    }
  EXPECT_EQ(code(ILAW_DELASSUS_TRANSVERSE, 1, {2.0, nan_value}), ILAW_OK);
  EXPECT_EQ(code(ILAW_DELASSUS_TRANSVERSE, 1, {0.0, 1.0}), ILAW_BAD_NODES);
}

}  // namespace
}  // namespace ilaw::testing

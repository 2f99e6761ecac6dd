// Laws as papers and codes print them, to be judged. Not for use. See docs/published_laws.md.
#include "impact_springs.hpp"
#include "lagged_friction.hpp"
#include "park_paulino_roesler.hpp"

ILAW_PLUGIN("published_laws", "1.0.0", "ilaw", "BSD-3-Clause", published::hunt_crossley,
            published::lankarani_nikravesh, published::regularized_coulomb, published::lagged_coulomb,
            published::park_paulino_roesler)

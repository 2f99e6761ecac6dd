// Contacts that share degrees of freedom: block Gauss-Seidel over the laws ends where every law holds.
#include "host_runner.hpp"

namespace ilaw::host::testing {
namespace {

// The mesh below moves under a point along flat facets: the gap must not notice where one ends and the next
// begins.
TEST(NodeToFacet, GapIsContinuousAcrossFacetsAndOpenBeyondTheBorder) {
  Scene scene = scene_of(until_at_cfl(
      0.4, 0.5,
      scene_of_blocks({block("a", {0, 0, 0}, {1, 1, 0.5}, {4, 4, 1}, elastic(100, 0.2, 1)),
                       block("b", {0.3, 0.3, 0.6}, {0.2, 0.2, 0.2}, {1, 1, 1}, elastic(50, 0.3, 1))},
                      {law_between("b.z_min", {{"surface", "a.z_max"}, {"discretization", "node_to_facet"}},
                                   "contact")})));
  Interface& interface = *scene.interfaces[0];
  const Counterpart& counterpart = *interface.setup().counterpart;
  Dofs u = Dofs::Zero(scene.model->mass().size());
  const int node = interface.nodes()[0];
  for (const double z : {0.03, -0.01})
    for (double x = -0.29; x < 0.69; x += 0.013) {
      u[3 * node] = x;
      u[3 * node + 1] = 0.5 * x;
      u[3 * node + 2] = -0.1 + z;
      interface.setup().counterpart->follow(u);
      const ContactPoint contact_point = counterpart.contact_point(0, u, 0.0);
      EXPECT_NEAR(contact_point.gap, z, 1e-15) << x;
      EXPECT_NEAR(contact_point.normal[2], 1.0, 1e-15) << "x " << x;
      double sum = 0.0;
      Eigen::Vector3d foot = Eigen::Vector3d::Zero();
      for (const auto& [partner, weight] : contact_point.partners) {
        sum += weight;
        foot += weight * scene.model->position().segment<3>(3 * Eigen::Index{partner});
      }
      EXPECT_NEAR(sum, 1.0, 1e-15) << "x " << x;
      EXPECT_LE((foot - Eigen::Vector3d(0.3 + x, 0.3 + 0.5 * x, 0.5)).norm(), 1e-14) << "x " << x;
      EXPECT_LE(counterpart.gap_bound(0, u, 0.0), contact_point.gap) << "x " << x;
    }
  u[3 * node] = -0.5;  // 0.2 beyond the border, and below the surface
  interface.setup().counterpart->follow(u);
  EXPECT_GT(counterpart.contact_point(0, u, 0.0).gap, 0.2);
}

// Balls of mass 1 that rest on each other in a column, a little compressed: rounding opens no contact. Where
// there are more, they are a column of their own beside it.
json column_scene(int balls, int more = 0) {
  std::vector<json> points, interfaces;
  for (int k = 0; k < balls + more; ++k) {
    const int place = k < balls ? k : k - balls;
    points.push_back(point(1, {place + 0.5}));
    interfaces.push_back(place == 0 ? law_on({k}, ground(1), "contact")
                                    : law_between({k}, {{"nodes", {k - 1}}, {"normal", {1}}}, "contact"));
    interfaces.back()["gap_offset"] = place == 0 ? 0.501 : 1.001;
  }
  return until(0.01, 0.001, scene_of_points(points, interfaces, {gravity({-10})}));
}
Scene column(int balls, int more = 0) { return scene_of(column_scene(balls, more).dump()); }
constexpr int too_long = 2100;  // for Newton's method, too

// The residual is the last change of an impulse: it bounds by how much impulses differ from those of the
// laws.
TEST(Column, WarnsWhenTooLong) {
  Scene scene = column(too_long);
  host::Integrator integrator = unaudited(scene);
  integrator.start();
  EXPECT_GE(integrator.tally().sweeps_max, 999);
  EXPECT_EQ(integrator.tally().unconverged, 1);
  const double arrives = 0.5 * 10.0 * 0.001;  // half a step's kick
  double largest = 0.0, energy = 0.0, at_worst_node = 0.0;
  for (const auto& contact : scene.interfaces) {
    const int contact_index = contact->active().at(0);
    const double r = contact->impulse(contact_index)[0], own = contact->delassus(contact_index) * r,
                 left = contact->relative(contact_index, integrator.velocity())[0], v_free = left - own;
    const double off = std::abs(own - std::max(0.0, -v_free));
    largest = std::max(largest, off);
    if (contact->node_of(contact_index) == integrator.tally().worst_node) at_worst_node = off;
    energy += 0.5 * std::abs(r * left);  // what r does beyond r.(v^- + 0)/2, as the law accounts for it
  }
  EXPECT_NEAR(integrator.tally().coupling_energy, energy, 1e-3 * energy);
  EXPECT_GT(largest, 0.0);
  EXPECT_GE(at_worst_node, 0.3 * largest);
  EXPECT_GE(integrator.tally().coupling_residual_max, (1.0 - 1e-3) * largest / arrives);
  EXPECT_LE(integrator.tally().coupling_residual_max, 3.0 * largest / arrives);
  ASSERT_EQ(integrator.warnings().size(), 1U);
  EXPECT_THAT(integrator.warnings()[0],
              HasSubstr("not solved in 1 of 1 steps, the start included: residual up to"));
}

// A short column beside it is solved. The first 30 iterations have one common direction, so that the residual
// of the long one is of the same size, but not the same.
TEST(Column, WarnsWhenOneOfTwoIsTooLong) {
  Scene alone = column(too_long), both = column(too_long, 30);
  host::Integrator of_one = unaudited(alone), of_both = unaudited(both);
  of_one.start();
  of_both.start();
  EXPECT_EQ(of_both.tally().unconverged, 1);
  EXPECT_GE(of_both.tally().sweeps_max, 999);
  const double residual = of_one.tally().coupling_residual_max;
  EXPECT_GT(of_both.tally().coupling_residual_max, 0.1 * residual);
  EXPECT_LT(of_both.tally().coupling_residual_max, 10.0 * residual);
}

// On stderr, in the run's line and in the summary.
TEST(RunWarnings, AreSaidByTheProgram) {
  const auto folder = fresh_folder();
  json scene = column_scene(too_long);
  scene["time"]["end"] = 0.001;
  EXPECT_THAT(run_scene(scene, folder),
              Exits(0, AllOf(HasSubstr("warning: contacts that share nodes are not solved in"),
                             HasSubstr(", with warnings; results in"))));
  const auto summary = json_of(folder / "summary.json");
  EXPECT_THAT(summary.at("warnings").dump(), HasSubstr("are not solved in"));
}

}  // namespace
}  // namespace ilaw::host::testing

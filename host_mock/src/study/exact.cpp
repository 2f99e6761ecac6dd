// SPDX-License-Identifier: BSD-3-Clause
#include "study/exact.hpp"

#include "base/scene_error.hpp"
#include "study/exact_postit.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace ilaw::host {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& expected) { throw SceneError("/exact", "expected " + expected); }

void require(bool good, const std::string& expected) {
  if (!good) refuse(expected);
}

// Velocity that is constant between instants; displacement is its integral from 0.
ExactNode piecewise(const std::vector<double>& instants, const std::vector<double>& velocities) {
  const auto velocity = [=](double time) {
    const auto k = std::upper_bound(instants.begin(), instants.end(), time) - instants.begin();
    return velocities[static_cast<std::size_t>(k)];
  };
  const auto displacement = [=](double time) {
    double sum = 0.0, from = 0.0;
    for (std::size_t k = 0; k < velocities.size() && from < time; ++k) {
      const double to = k < instants.size() ? std::min(instants[k], time) : time;
      sum += velocities[k] * (to - from);
      from = to;
    }
    return sum;
  };
  return {displacement, velocity, {}};
}

// First fall t1 = sqrt(2 h0/g); flights of 2 e^k t1, which start with e^k g t1 (Moreau 1988).
ExactNode bouncing_ball(const Scene& scene) {
  const json& model = scene.source["model"];
  const std::string wanted = "one point at rest in 1D under gravity, above a plane, with law 'contact'";
  require(model["type"] == "points" && model["points"].size() == 1 && model["dimension"] == 1, wanted);
  const json loads = scene.source.value("loads", json::array());
  require(loads.size() == 1 && loads[0]["type"] == "gravity" && !model["points"][0].contains("velocity"),
          wanted);
  const json& interface = scene.source["interfaces"][0];
  require(scene.source["interfaces"].size() == 1 && interface["law"] == "contact" &&
              interface.contains("obstacle"),
          wanted);
  const double g = -loads[0]["acceleration"][0].get<double>();
  const double height =
      model["points"][0]["position"][0].get<double>() - interface["obstacle"]["point"][0].get<double>();
  require(g > 0.0 && height > 0.0, wanted);
  const double e = interface.value("parameters", json::object()).value("restitution", 0.0);
  const double fall = std::sqrt(2.0 * height / g), mass = model["points"][0]["mass"].get<double>();

  // Start and speed of the flight that is under way.
  const auto flight = [=](double time) {
    double start = fall, speed = e * g * fall;
    const double rest = e < 1.0 ? fall * (1.0 + e) / (1.0 - e) : INFINITY;
    if (time >= rest) return std::pair{time, 0.0};
    while (time > start + 2.0 * speed / g) {
      start += 2.0 * speed / g;
      speed *= e;
    }
    return std::pair{start, speed};
  };
  ExactNode node;
  node.displacement = [=](double time) {
    if (time < fall) return -0.5 * g * time * time;
    const auto [start, speed] = flight(time);
    return -height + (time - start) * (speed - 0.5 * g * (time - start));
  };
  node.velocity = [=](double time) {
    if (time < fall) return -g * time;
    const auto [start, speed] = flight(time);
    return speed - g * (time - start);
  };
  node.instants.first_impulse = fall;
  // The momentum that gravity alone does not explain; what is missing of the speed of the first fall.
  node.impulse = [=, velocity = node.velocity](double time) { return mass * (velocity(time) + g * time); };
  node.work = [=](double time) {
    if (time < fall) return 0.0;
    const double speed = flight(time).second;
    return 0.5 * mass * (speed * speed - g * fall * g * fall);
  };
  node.energy = mass * g * height;
  return node;
}

// Thrown along a plane from above it, under gravity: bounces as above, of which every one takes
// mu (1 + e) times the speed of arrival from the sliding, as long as there is any (Moreau 1988); then
// mu g.
struct ThrownPoint {
  struct Motion {
    double x, y, vx, vy;  // from where it started; along the plane and across it
  };

  double mass, gravity, height, speed, e, mu;

  double fall() const { return std::sqrt(2.0 * height / gravity); }
  double energy() const { return mass * (gravity * height + 0.5 * speed * speed); }
  Motion at(double time) const {
    const double g = gravity, rest = fall() * (1.0 + e) / (1.0 - e);
    if (time < fall()) return {speed * time, -0.5 * g * time * time, speed, -g * time};
    double since = fall(), x = speed * fall(), vx = speed, arrives = g * fall();
    for (double part = 1.0; part > 1e-18; part *= e) {
      vx = std::max(vx - mu * (1.0 + e) * arrives, 0.0);
      arrives *= e;
      const double flight = std::min(2.0 * arrives / g, rest - since);
      if (time < since + flight) {
        const double t = time - since;
        return {x + vx * t, -height + t * (arrives - 0.5 * g * t), vx, arrives - g * t};
      }
      since += flight;
      x += vx * flight;
    }
    const double t = std::min(time - rest, vx / (mu * g));
    return {x + t * (vx - 0.5 * mu * g * t), -height, vx - mu * g * t, 0.0};
  }
};

ThrownPoint thrown_point_of(const Scene& scene) {
  const json& model = scene.source["model"];
  const json& interface = scene.source["interfaces"][0];
  const json parameters = interface.value("parameters", json::object());
  const json loads = scene.source.value("loads", json::array());
  const std::string wanted =
      "one point in 2D that is thrown along a plane with normal [0, 1], under gravity, with law 'coulomb', "
      "friction and a restitution below 1";
  require(model["type"] == "points" && model["dimension"] == 2 && model["points"].size() == 1 &&
              interface["law"] == "coulomb" && interface.contains("obstacle") && loads.size() == 1 &&
              loads[0]["type"] == "gravity" && parameters.value("friction", 0.0) > 0.0,
          wanted);
  const json& point = model["points"][0];
  const json& obstacle = interface["obstacle"];
  const json velocity = point.value("velocity", json{0.0, 0.0});
  require(obstacle["type"] == "plane" && obstacle["normal"][0] == 0.0 && velocity[1] == 0.0, wanted);
  const ThrownPoint thrown{point["mass"].get<double>(),
                           -loads[0]["acceleration"][1].get<double>(),
                           point["position"][1].get<double>() - obstacle["point"][1].get<double>(),
                           velocity[0].get<double>(),
                           parameters.value("restitution", 0.0),
                           parameters["friction"].get<double>()};
  require(thrown.gravity > 0.0 && thrown.height > 0.0 && thrown.e < 1.0 && thrown.speed > 0.0, wanted);
  return thrown;
}

std::vector<ExactNode> oblique_impact(const Scene& scene) {
  const ThrownPoint thrown = thrown_point_of(scene);
  ExactNode along, across;
  along.displacement = [=](double time) { return thrown.at(time).x; };
  along.velocity = [=](double time) { return thrown.at(time).vx; };
  along.impulse = [=](double time) { return thrown.mass * (thrown.at(time).vx - thrown.speed); };
  along.energy = thrown.energy();
  along.work = [=](double time) {
    const auto [x, y, vx, vy] = thrown.at(time);
    return thrown.mass * (0.5 * (vx * vx + vy * vy) + thrown.gravity * (thrown.height + y)) - thrown.energy();
  };
  along.instants.first_impulse = thrown.fall();
  across.displacement = [=](double time) { return thrown.at(time).y; };
  across.velocity = [=](double time) { return thrown.at(time).vy; };
  across.impulse = [=](double time) { return thrown.mass * (thrown.at(time).vy + thrown.gravity * time); };
  return {along, across};
}

struct Bar {
  double start, length, young, density, section, velocity;
  double wave_speed() const { return std::sqrt(young / density); }
  double impedance() const { return section * std::sqrt(young * density); }
  double mass() const { return density * section * length; }
};

Bar bar_of(const Scene& scene, std::size_t k) {
  const json& bar = scene.source["model"]["bars"][k];
  return {bar.value("start", 0.0),      bar["length"].get<double>(), bar["young"].get<double>(),
          bar["density"].get<double>(), bar.value("section", 1.0),   bar.value("velocity", 0.0)};
}

// Contact for the return time 2L/c of a wave, at rest, then rebound at the speed of impact (Doyen
// et al. 2011).
ExactNode bar_on_wall(const Scene& scene) {
  require(scene.source["model"]["type"] == "bars" && scene.source["model"]["bars"].size() == 1 &&
              scene.source.value("loads", json::array()).empty() &&
              scene.source["interfaces"][0].contains("obstacle"),
          "one bar that flies against a plane, no loads");
  const Bar bar = bar_of(scene, 0);
  const double gap = bar.start - scene.source["interfaces"][0]["obstacle"]["point"][0].get<double>();
  require(gap >= 0.0 && bar.velocity < 0.0, "a bar that flies towards the plane");
  const double meets = -gap / bar.velocity, leaves = meets + 2.0 * bar.length / bar.wave_speed();
  ExactNode node = piecewise({meets, leaves}, {bar.velocity, 0.0, -bar.velocity});
  node.instants.first_impulse = meets;
  node.instants.last_impulse = leaves;
  const double force = -bar.impedance() * bar.velocity;
  node.impulse = [=](double time) { return force * (std::clamp(time, meets, leaves) - meets); };
  node.work = [](double /*time*/) { return 0.0; };
  node.energy = 0.5 * bar.mass() * bar.velocity * bar.velocity;
  return node;
}

// While no wave has come back both ends move at (Z_A v_A + Z_B v_B)/(Z_A + Z_B). With equal
// impedances the shorter bar is then at rest relative to the longer one's initial speed, and so is
// the longer one's end, until its own wave is back.
std::vector<ExactNode> two_bars(const Scene& scene) {
  require(scene.source["model"]["type"] == "bars" && scene.source["model"]["bars"].size() == 2 &&
              scene.source.value("loads", json::array()).empty() && scene.output.watch.size() == 2,
          "two bars, no loads, and both ends watched, that of the right bar first");
  const Bar a = bar_of(scene, 0), b = bar_of(scene, 1);
  const double gap = b.start - (a.start + a.length);
  require(gap >= 0.0 && a.velocity > b.velocity, "a left bar that catches up with the right one");
  const double meets = gap / (a.velocity - b.velocity);
  const double back_a = 2.0 * a.length / a.wave_speed(), back_b = 2.0 * b.length / b.wave_speed();
  const double together =
      (a.impedance() * a.velocity + b.impedance() * b.velocity) / (a.impedance() + b.impedance());
  const double end = scene.dt * static_cast<double>(scene.steps),
               first_back = meets + std::min(back_a, back_b);
  const bool equal = std::abs(a.impedance() - b.impedance()) <= 1e-12 * a.impedance() && back_a <= back_b;
  require(end <= first_back || (equal && end <= meets + std::max(back_a, back_b)),
          "an end before the first wave comes back, or a shorter left bar of equal impedance and an end "
          "before the "
          "second does");
  const auto node = [&](double before) {
    ExactNode exact = piecewise({meets, first_back}, {before, together, b.velocity});
    exact.instants.first_impulse = meets;
    return exact;
  };
  std::vector<ExactNode> nodes{node(b.velocity), node(a.velocity)};
  const double force = b.impedance() * (together - b.velocity);
  nodes[0].impulse = [=](double time) { return force * (std::clamp(time, meets, first_back) - meets); };
  nodes[0].work = [](double /*time*/) { return 0.0; };
  nodes[0].energy = 0.5 * (a.mass() * a.velocity * a.velocity + b.mass() * b.velocity * b.velocity);
  return nodes;
}

// The glue feels 2F from L/c on; it breaks R_Y/(2F) later if its window is longer, and the end then
// moves at 2F/Z until the next reflection at 3L/c.
ExactNode glued_bar(const Scene& scene) {
  const json loads = scene.source.value("loads", json::array());
  const json& interface = scene.source["interfaces"][0];
  const std::string wanted =
      "one bar, glued on the left by law 'postit' with initial_adhesion and memory, pulled at "
      "its right end by a constant force";
  require(scene.source["model"]["type"] == "bars" && scene.source["model"]["bars"].size() == 1, wanted);
  require(loads.size() == 1 && loads[0]["type"] == "force" && loads[0]["history"].size() == 1, wanted);
  require(interface["law"] == "postit" && interface.contains("parameters"), wanted);
  const json& parameters = interface["parameters"];
  require(parameters.contains("initial_adhesion") && parameters.value("memory", json(0.0)).is_number(),
          wanted);
  const Bar bar = bar_of(scene, 0);
  const double force = loads[0]["history"][0][1].get<double>() * loads[0]["direction"][0].get<double>();
  const double adhesion = parameters["initial_adhesion"].get<double>() * bar.section;
  const double arrives = bar.length / bar.wave_speed(), breaks = arrives + adhesion / (2.0 * force);
  require(force > 0.0 && parameters["memory"].get<double>() > adhesion / (2.0 * force) &&
              breaks < 3.0 * arrives && scene.dt * static_cast<double>(scene.steps) <= 3.0 * arrives,
          "a window longer than R_Y/(2F), and an end before the next reflection at 3L/c");
  ExactNode node = piecewise({breaks}, {0.0, 2.0 * force / bar.impedance()});
  node.instants.last_rupture = breaks;
  node.impulse = [=](double time) { return -2.0 * force * (std::clamp(time, arrives, breaks) - arrives); };
  node.work = [](double /*time*/) { return 0.0; };
  node.energy = 2.0 * force * force * bar.length / (bar.young * bar.section);  // the load's work up to 2L/c
  return node;
}

// A bar dropped on a plane, which it leaves as a whole after 2L/c: undeformed before the first impact,
// compressed by twice its weight after it, and undeformed again after the second if the flight between
// took a whole number of its vibrations, which then bring its end back (docs/scenes.md).
ExactNode bouncing_bar(const Scene& scene) {
  const json loads = scene.source.value("loads", json::array());
  const json& interface = scene.source["interfaces"][0];
  const std::string wanted = "one bar at rest, undeformed and under gravity, above a plane";
  require(scene.source["model"]["type"] == "bars" && scene.source["model"]["bars"].size() == 1, wanted);
  require(loads.size() == 1 && loads[0]["type"] == "gravity" && !loads[0].contains("nodes"), wanted);
  require(interface.contains("obstacle") && scene.model->initial_displacement().isZero(0.0), wanted);
  const Bar bar = bar_of(scene, 0);
  const double g = -loads[0]["acceleration"][0].get<double>(),
               height = bar.start - interface["obstacle"]["point"][0].get<double>();
  require(g > 0.0 && height > 0.0 && bar.velocity == 0.0, wanted);
  const double fall = std::sqrt(2.0 * height / g), stay = 2.0 * bar.length / bar.wave_speed(),
               vibrations = 2.0 * fall / stay;
  require(std::abs(vibrations - std::round(vibrations)) <= 1e-9 * vibrations && vibrations > 1.5,
          "a flight of 2 sqrt(2 h/g) that is a multiple of the vibration's period 2L/c, by 2 at least");

  // Position above the plane and velocity, s after a start upwards at the speed of the fall.
  const auto thrown = [=](double s) { return std::pair{g * s * (fall - 0.5 * s), g * (fall - s)}; };
  const auto motion = [=](double time) {
    double s = std::fmod(time, 4.0 * fall + 2.0 * stay);
    if (s < fall) return thrown(s + fall);
    if ((s -= fall) < stay) return std::pair{0.0, 0.0};
    if ((s -= stay) < 2.0 * fall) {
      const double r = std::fmod(s, stay);  // of the vibration
      const auto [position, velocity] = thrown(s);
      return std::pair{position - g * r * (stay - r), velocity - g * (stay - 2.0 * r)};
    }
    if ((s -= 2.0 * fall) < stay) return std::pair{0.0, 0.0};
    return thrown(s - stay);
  };
  ExactNode node;
  node.displacement = [=](double time) { return motion(time).first - height; };
  node.velocity = [=](double time) { return motion(time).second; };
  node.instants.first_impulse = fall;
  return node;
}

// A rod stretched by a over its length, let go, its far end held: it falls at c a/L, rests on the plane
// while the waves cross, and is thrown back to where it was, each for L/c.
ExactNode held_rod(const Scene& scene) {
  const json loads = scene.source.value("loads", json::array());
  const json& interface = scene.source["interfaces"][0];
  const std::string wanted =
      "one bar at rest, stretched away from a plane at its left end, its right end held, no other load";
  require(scene.source["model"]["type"] == "bars" && scene.source["model"]["bars"].size() == 1, wanted);
  require(loads.size() == 1 && loads[0]["type"] == "motion" &&
              scene.loads[0]->prescribed_nodes().size() == 1 && !loads[0].contains("velocity") &&
              !loads[0].contains("path"),
          wanted);
  const Bar bar = bar_of(scene, 0);
  const Dofs& start = scene.model->initial_displacement();
  const Eigen::Index right = start.size() - 1;
  const double a = start[0];
  require(scene.loads[0]->prescribed_nodes()[0] == right && start[right] == 0.0 && a > 0.0, wanted);
  require(interface.contains("obstacle") && bar.velocity == 0.0 &&
              interface["obstacle"]["point"][0].get<double>() == bar.start,
          wanted);
  const double third = bar.length / bar.wave_speed(), speed = a / third;
  ExactNode node;
  node.displacement = [=](double time) {
    return speed * std::max(std::abs(std::fmod(time, 3.0 * third) - 1.5 * third) - 0.5 * third, 0.0);
  };
  node.velocity = [=](double time) {
    const double s = std::fmod(time, 3.0 * third);
    return s < third ? -speed : s < 2.0 * third ? 0.0 : speed;
  };
  node.instants.first_impulse = third;
  return node;
}

// The sum of the forces on a point: linear between the knots of all of them.
std::vector<PostitPoint::Knot> pull_of(const Scene& scene, const json& loads) {
  std::set<double> times{0.0};
  for (const json& load : loads)
    if (load["type"] == "force")
      for (const json& row : load["history"]) times.insert(row[0].get<double>());
  std::vector<PostitPoint::Knot> knots;
  for (const double time : times) {
    Dofs force = Dofs::Zero(1);
    for (const auto& load : scene.loads) load->add_force(time, force);
    knots.push_back({time, force[0]});
  }
  return knots;
}

// A point that rests on a plane, with shocks of any sign and forces that pull.
ExactNode postit_point(const Scene& scene) {
  const json& model = scene.source["model"];
  const json& interface = scene.source["interfaces"][0];
  const json loads = scene.source.value("loads", json::array());
  const std::string wanted =
      "one point at rest in 1D on a plane, with law 'postit', brittle rupture, shocks, and forces that pull";
  require(model["type"] == "points" && model["points"].size() == 1 && model["dimension"] == 1, wanted);
  const json& body = model["points"][0];
  require(!body.contains("stiffness") && scene.model->initial_velocity()[0] == 0.0, wanted);
  require(scene.source["interfaces"].size() == 1 && interface["law"] == "postit" &&
              interface.contains("obstacle") && interface["obstacle"]["type"] == "plane" &&
              interface["obstacle"]["point"] == body["position"] &&
              interface["obstacle"]["normal"][0].get<double>() > 0.0,
          wanted);
  const json parameters = interface.value("parameters", json::object());
  const auto value = [&](const char* name, double otherwise) {
    const json given = parameters.value(name, json(otherwise));
    require(given.is_number() || given == "inf", std::string("a number for '") + name + "'");
    return given.is_number() ? given.get<double>() : INFINITY;
  };
  require(parameters.value("rupture", "brittle") == "brittle", wanted);
  const double area = body.value("area", 1.0);
  PostitPoint point{scene.model->mass()[0],
                    pull_of(scene, loads),
                    {},
                    value("initial_adhesion", 0.0) * area,
                    0.0,
                    value("efficiency_decrease", INFINITY),
                    value("memory", 0.0),
                    scene.dt * static_cast<double>(scene.steps + 1)};
  const double limit = value("adhesion_limit", INFINITY);
  point.adhesion_limit = limit < INFINITY ? limit * area : limit;
  for (const json& load : loads) {
    require(load["type"] == "force" || load["type"] == "shock", wanted);
    if (load["type"] == "shock")
      point.shocks.push_back({load["time"].get<double>(), load["impulse"][0].get<double>()});
  }
  for (const PostitPoint::Knot& knot : point.knots) require(knot.force >= 0.0, wanted);
  std::stable_sort(point.shocks.begin(), point.shocks.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  return postit_motion(point);
}

}  // namespace

std::vector<ExactNode> exact_solution(const Scene& scene) {
  if (!scene.source.contains("exact")) return {};
  const std::string type = scene.source["exact"]["type"].get<std::string>();
  if (type == "two_bars") return two_bars(scene);
  if (type == "oblique_impact") {
    require(scene.output.watch.size() == 1, "one watched node, the one in contact");
    return oblique_impact(scene);
  }
  require(scene.output.watch.size() == 1, "one watched node, the one in contact");
  using Solution = ExactNode (*)(const Scene&);
  static const std::map<std::string, Solution> solutions{
      {"bouncing_ball", bouncing_ball}, {"bar_on_wall", bar_on_wall}, {"bouncing_bar", bouncing_bar},
      {"held_rod", held_rod},           {"glued_bar", glued_bar},     {"postit_point", postit_point}};
  return {solutions.at(type)(scene)};
}

}  // namespace ilaw::host

// SPDX-License-Identifier: BSD-3-Clause
#include "study/exact.hpp"

#include "study/exact_parts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace ilaw::host {
namespace {

using nlohmann::json;

// Thrown along a plane from above it, under gravity. First fall t1 = sqrt(2 h0/g); flights of 2 e^k t1, which
// start with e^k g t1 (Moreau 1988). Every bounce takes mu (1 + e) times the speed of arrival from the
// sliding, as long as there is any; then mu g does.
struct ThrownPoint {
  struct Motion {
    double x, y, vx, vy;  // from where it started; along the plane and across it
  };

  double mass, gravity, height, speed, e, mu;

  double fall() const { return std::sqrt(2.0 * height / gravity); }
  double energy() const { return mass * (gravity * height + 0.5 * speed * speed); }
  Motion at(double time) const {
    const double g = gravity, rest = e < 1.0 ? fall() * (1.0 + e) / (1.0 - e) : INFINITY;
    if (time < fall()) return {speed * time, -0.5 * g * time * time, speed, -g * time};
    double since = fall(), x = speed * fall(), vx = speed, arrives = g * fall();
    while (arrives > 1e-18 * g * fall()) {
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
    const double t = vx > 0.0 ? std::min(time - rest, vx / (mu * g)) : 0.0;
    return {x + t * (vx - 0.5 * mu * g * t), -height, vx - mu * g * t, 0.0};
  }
  double work(double time) const {
    const auto [x, y, vx, vy] = at(time);
    return mass * (0.5 * (vx * vx + vy * vy) + gravity * (height + y)) - energy();
  }
};

// Its motion across the plane. The impulse is the momentum that gravity alone does not explain.
ExactNode across(const ThrownPoint& thrown) {
  ExactNode node = node_of([=](double time) {
    const auto now = thrown.at(time);
    return Motion1D{now.y, now.vy};
  });
  node.impulse = [=](double time) { return thrown.mass * (thrown.at(time).vy + thrown.gravity * time); };
  return node;
}

ExactNode bouncing_ball(const Scene& scene) {
  const std::string wanted = "one point at rest in 1D under gravity, above a plane, with law 'contact'";
  const auto [model, point, interface, loads, parameters] = one_body(scene, "points", wanted);
  require(model["dimension"] == 1 && loads.size() == 1 && loads[0]["type"] == "gravity" &&
              !point.contains("velocity") && scene.source["interfaces"].size() == 1 &&
              interface["law"] == "contact" && interface.contains("obstacle"),
          wanted);
  const double g = -loads[0]["acceleration"][0].get<double>();
  const double height = point["position"][0].get<double>() - interface["obstacle"]["point"][0].get<double>();
  require(g > 0.0 && height > 0.0, wanted);
  const ThrownPoint ball{point["mass"].get<double>(),          g,  height, 0.0,
                         parameters.value("restitution", 0.0), 0.0};
  ExactNode node = across(ball);
  node.instants.first_impulse = ball.fall();
  node.work = [=](double time) { return ball.work(time); };
  node.energy = ball.energy();
  return node;
}

// On a spring at rest length above a stop: u = A cos(w t - phi) about where it starts, until it meets the
// stop at -gap, from where it leaves at e times its speed.
struct StoppedSwing {
  struct Motion {
    double u, v, impulse, work;
  };

  double mass, frequency, gap, speed, e;

  Motion at(double time) const {
    Motion now{0.0, speed, 0.0, 0.0};
    for (;;) {
      const double size = std::hypot(now.u, now.v / frequency), phase = std::atan2(now.v / frequency, now.u),
                   until = size > gap ? (phase + std::acos(-gap / size)) / frequency : INFINITY;
      if (time < until) {
        now.u = size * std::cos(frequency * time - phase);
        now.v = -frequency * size * std::sin(frequency * time - phase);
        return now;
      }
      time -= until;
      const double arrives = frequency * std::sqrt((size - gap) * (size + gap));
      now.u = -gap;
      now.v = e * arrives;
      now.impulse += mass * (1.0 + e) * arrives;
      now.work -= 0.5 * mass * (1.0 - e * e) * arrives * arrives;
    }
  }
};

ExactNode impact_oscillator(const Scene& scene) {
  const std::string wanted =
      "one point in 1D on a spring, thrown above a plane, without loads, with law 'contact'";
  const auto [model, point, interface, loads, parameters] = one_body(scene, "points", wanted);
  require(model["dimension"] == 1 && point.contains("stiffness") && scene.loads.empty() &&
              scene.source["interfaces"].size() == 1 && interface["law"] == "contact" &&
              interface.contains("obstacle") && interface["obstacle"]["type"] == "plane" &&
              interface["obstacle"]["normal"][0].get<double>() > 0.0,
          wanted);
  const double mass = point["mass"].get<double>(), stiffness = point["stiffness"][0].get<double>();
  const StoppedSwing swing{
      mass, std::sqrt(stiffness / mass),
      point["position"][0].get<double>() - interface["obstacle"]["point"][0].get<double>(),
      point.value("velocity", json{0.0})[0].get<double>(), parameters.value("restitution", 0.0)};
  require(stiffness > 0.0 && swing.gap > 0.0 && swing.speed != 0.0, wanted);
  ExactNode node = node_of([=](double time) {
    const auto now = swing.at(time);
    return Motion1D{now.u, now.v};
  });
  node.impulse = [=](double time) { return swing.at(time).impulse; };
  node.work = [=](double time) { return swing.at(time).work; };
  const double size = std::fabs(swing.speed) / swing.frequency;
  if (size > swing.gap)
    node.instants.first_impulse =
        (std::acos(-swing.gap / size) + std::copysign(0.5 * M_PI, swing.speed)) / swing.frequency;
  node.energy = 0.5 * mass * swing.speed * swing.speed;
  return node;
}

ThrownPoint thrown_point_of(const Scene& scene) {
  const std::string wanted =
      "one point in 2D that is thrown along a plane with normal [0, 1], under gravity, with law 'coulomb', "
      "friction and a restitution below 1";
  const auto [model, point, interface, loads, parameters] = one_body(scene, "points", wanted);
  require(model["dimension"] == 2 && interface["law"] == "coulomb" && interface.contains("obstacle") &&
              loads.size() == 1 && loads[0]["type"] == "gravity" && parameters.value("friction", 0.0) > 0.0,
          wanted);
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
  ExactNode along = node_of([=](double time) {
    const auto now = thrown.at(time);
    return Motion1D{now.x, now.vx};
  });
  along.impulse = [=](double time) { return thrown.mass * (thrown.at(time).vx - thrown.speed); };
  along.energy = thrown.energy();
  along.work = [=](double time) { return thrown.work(time); };
  along.instants.first_impulse = thrown.fall();
  return {along, across(thrown)};
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
    for (const auto& load : scene.loads) load->add_force(time, scene.model->initial_displacement(), force);
    knots.push_back({time, force[0]});
  }
  return knots;
}

// A point that rests on a plane, with shocks of any sign and forces that pull.
ExactNode postit_point(const Scene& scene) {
  const std::string wanted =
      "one point at rest in 1D on a plane, with law 'postit', brittle rupture, shocks, and forces that pull";
  const OneBody one = one_body(scene, "points", wanted);
  const json &body = one.body, &interface = one.interface, &loads = one.loads;
  require(
      one.model["dimension"] == 1 && !body.contains("stiffness") && scene.model->initial_velocity()[0] == 0.0,
      wanted);
  require(scene.source["interfaces"].size() == 1 && interface["law"] == "postit" &&
              interface.contains("obstacle") && interface["obstacle"]["type"] == "plane" &&
              interface["obstacle"]["point"] == body["position"] &&
              interface["obstacle"]["normal"][0].get<double>() > 0.0,
          wanted);
  const auto value = [&](const char* name, double otherwise) {
    const json given = one.parameters.value(name, json(otherwise));
    require(given.is_number() || given == "inf", std::string("a number for '") + name + "'");
    return given.is_number() ? given.get<double>() : INFINITY;
  };
  require(one.parameters.value("rupture", "brittle") == "brittle", wanted);
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
  require(!scene.source.contains("springs"), "a scene without 'springs'");
  require(scene.source["exact"]["type"] == "held_rod" || !scene.source.contains("initial"),
          "a scene without 'initial'");
  for (const json& interface : scene.source["interfaces"])
    for (const char* key : {"rate", "angles"})
      require(!interface.contains("obstacle") || !interface["obstacle"].contains(key),
              "obstacles that do not turn");
  const std::string type = scene.source["exact"]["type"].get<std::string>();
  if (type == "two_bars") return two_bars(scene);
  require(scene.output.watch.size() == 1, "one watched node, the one in contact");
  if (type == "oblique_impact") return oblique_impact(scene);
  using Solution = ExactNode (*)(const Scene&);
  static const std::map<std::string, Solution> solutions{
      {"bouncing_ball", bouncing_ball}, {"impact_oscillator", impact_oscillator},
      {"bar_on_wall", bar_on_wall},     {"bouncing_bar", bouncing_bar},
      {"held_rod", held_rod},           {"glued_bar", glued_bar},
      {"postit_point", postit_point}};
  return {solutions.at(type)(scene)};
}

}  // namespace ilaw::host

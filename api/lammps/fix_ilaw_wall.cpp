// SPDX-License-Identifier: BSD-3-Clause
#include "fix_ilaw_wall.hpp"

#include <atom.h>
#include <update.h>

#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {
namespace {

using ilaw::lammps::Vector;

using ilaw::shapes::cross, ilaw::shapes::dot, ilaw::shapes::plus;
constexpr double parallel_tolerance = 1e-12;  // of the sine of an angle

}  // namespace

FixIlawWall::FixIlawWall(LAMMPS* lammps, int narg, char** arg) : FixIlaw(lammps, narg, arg) {
  read_words();
  if (walls_.empty()) refuse("expected a wall: plane, sphere or cylinder");
}

Vector FixIlawWall::read_vector(const std::vector<std::string>& words, std::size_t at) {
  return {number(words, at), number(words, at + 1), number(words, at + 2)};
}

FixIlawWall::Wall& FixIlawWall::last_wall(const std::string& word) {
  if (walls_.empty()) refuse(word + " has to follow a wall");
  return walls_.back();
}

void FixIlawWall::set_spin(Wall& wall, const Vector& spin) {
  const Vector off = cross(spin, wall.direction);
  if (dot(off, off) > parallel_tolerance * parallel_tolerance * dot(spin, spin))
    refuse("the spin of a plane must be along its normal, that of a cylinder along its axis");
  wall.spin = spin;
}

int FixIlawWall::read_own(const std::vector<std::string>& words, std::size_t at) {
  const std::string& word = words[at];
  if (word == "velocity") {
    last_wall(word).velocity = read_vector(words, at + 1);
    return 4;
  }
  if (word == "spin") {
    set_spin(last_wall(word), read_vector(words, at + 1));
    return 4;
  }
  if (word != "plane" && word != "sphere" && word != "cylinder") return 0;
  Wall wall{};
  wall.point = read_vector(words, at + 1);
  std::size_t next = at + 4;
  wall.shape = word == "plane" ? Shape::plane : word == "sphere" ? Shape::sphere : Shape::cylinder;
  if (wall.shape != Shape::sphere) {
    wall.direction = read_vector(words, next);
    const double length = std::sqrt(dot(wall.direction, wall.direction));
    if (!(length > 0.0)) refuse("the direction of a " + word + " is zero");
    for (double& component : wall.direction) component /= length;
    next += 3;
  }
  if (wall.shape != Shape::plane) {
    wall.radius = number(words, next++);
    if (!(wall.radius > 0.0)) refuse("the radius of a " + word + " must be larger than 0");
    if (next >= words.size() || (words[next] != "inside" && words[next] != "outside"))
      refuse("say whether grains are inside or outside of the " + word);
    wall.inside = words[next++] == "inside";
  }
  walls_.push_back(wall);
  return static_cast<int>(next - at);
}

Vector FixIlawWall::center(const Wall& wall) const { return plus(wall.point, wall.velocity, moved_time_); }

ilaw::shapes::surface FixIlawWall::surface(const Wall& wall, const Vector& x) const {
  const Vector from = plus(x, center(wall), -1.0);
  if (wall.shape == Shape::plane) return ilaw::shapes::plane(from, wall.direction);
  const auto outside = wall.shape == Shape::sphere
                           ? ilaw::shapes::sphere(from, wall.radius)
                           : ilaw::shapes::cylinder(from, wall.direction, wall.radius);
  return wall.inside ? ilaw::shapes::inside(outside) : outside;
}

// At the point of the wall that is nearest to an atom, where both are ahead by a time. Half a step ahead it
// is the mean over the step to O(h^2): the two-step method of Adams and Bashforth for a grain that sticks.
Vector FixIlawWall::velocity(const Wall& wall, int i, const Vector& nearest, double ahead) const {
  const Vector v = {atom->v[i][0], atom->v[i][1], atom->v[i][2]};
  const Vector arm = plus(plus(nearest, center(wall), -1.0), plus(v, wall.velocity, -1.0), ahead);
  return ilaw::shapes::velocity(wall.velocity, wall.spin, arm);
}

void FixIlawWall::find() {
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      ilaw::lammps::ContactSet::Contact contact{};
      contact.arm = atom->radius[i];
      const Vector x = {atom->x[i][0], atom->x[i][1], atom->x[i][2]};
      const auto [apart, normal] = surface(walls_[w], x);
      contact.normal = normal;
      contact.gap = apart - contact.arm;
      if (contact.gap >= contact.arm) continue;  // a wall's contacts begin one radius away
      contact.body = i;
      contact.counterpart = -1;
      contact.partner = -1.0 - static_cast<double>(w);
      const Vector nearest = plus(x, normal, -apart);
      contact.wall_velocity = velocity(walls_[w], i, nearest, 0.5 * update->dt);
      contact.wall_previous = velocity(walls_[w], i, nearest, -0.5 * update->dt);
      contact.wall_spin = walls_[w].spin;
      contact.area = area_ > 0.0 ? area_ : M_PI * contact.arm * contact.arm;
      contacts_->add(contact, row(i));
    }
  }
}

}  // namespace LAMMPS_NS

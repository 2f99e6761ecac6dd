// SPDX-License-Identifier: BSD-3-Clause
#include "fix_ilaw_wall.hpp"

#include <atom.h>
#include <update.h>

#include <algorithm>
#include <cmath>

namespace LAMMPS_NS {
namespace {

using ilaw::lammps::Vector;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
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

Vector FixIlawWall::center(const Wall& wall) const {
  Vector now = wall.point;
  for (std::size_t c = 0; c < 3; ++c) now[c] += moved_time_ * wall.velocity[c];
  return now;
}

double FixIlawWall::distance(const Wall& wall, const double* x, Vector& normal) const {
  Vector from = center(wall);
  for (std::size_t c = 0; c < 3; ++c) from[c] = x[c] - from[c];
  const double along = dot(from, wall.direction);
  if (wall.shape == Shape::plane) {
    normal = wall.direction;
    return along;
  }
  for (std::size_t c = 0; c < 3; ++c) from[c] -= along * wall.direction[c];  // a sphere has no axis
  const double length = std::sqrt(dot(from, from));
  const double sense = wall.inside ? -1.0 : 1.0;
  for (std::size_t c = 0; c < 3; ++c) normal[c] = sense * from[c] / length;
  return sense * (length - wall.radius);
}

// At the point of the wall that is nearest to an atom, where both are ahead by a time. Half a step ahead it
// is the mean over the step to O(h^2): the two-step method of Adams and Bashforth for a grain that sticks.
Vector FixIlawWall::velocity(const Wall& wall, int i, double distance, const Vector& normal,
                             double ahead) const {
  Vector from = center(wall);
  for (std::size_t c = 0; c < 3; ++c)
    from[c] = atom->x[i][c] - distance * normal[c] - from[c] + ahead * (atom->v[i][c] - wall.velocity[c]);
  Vector now = cross(wall.spin, from);
  for (std::size_t c = 0; c < 3; ++c) now[c] += wall.velocity[c];
  return now;
}

void FixIlawWall::find() {
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      ilaw::lammps::ContactSet::Contact contact{};
      contact.arm = atom->radius[i];
      const double apart = distance(walls_[w], atom->x[i], contact.normal);
      contact.gap = apart - contact.arm;
      if (contact.gap >= contact.arm) continue;  // a wall's contacts begin one radius away
      contact.body = i;
      contact.counterpart = -1;
      contact.partner = -1.0 - static_cast<double>(w);
      contact.wall_velocity = velocity(walls_[w], i, apart, contact.normal, 0.5 * update->dt);
      contact.wall_previous = velocity(walls_[w], i, apart, contact.normal, -0.5 * update->dt);
      contact.wall_spin = walls_[w].spin;
      contact.area = area_ > 0.0 ? area_ : M_PI * contact.arm * contact.arm;
      contacts_->add(contact, row(i));
    }
  }
}

}  // namespace LAMMPS_NS

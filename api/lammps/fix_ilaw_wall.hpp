// fix_ilaw_wall.hpp - fix ilaw/wall: a law between grains and planes, spheres and cylinders, fixed or moving.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fix_ilaw.hpp"

#include <ilaw/shapes.hpp>

namespace LAMMPS_NS {

class FixIlawWall : public FixIlaw {
 public:
  FixIlawWall(LAMMPS* lammps, int narg, char** arg);

 private:
  using Vector = ilaw::lammps::Vector;
  enum class Shape { plane, sphere, cylinder };
  struct Wall {
    Shape shape;
    Vector point;      // of the plane, centre, on the axis; at time 0
    Vector direction;  // unit normal of the plane, unit axis
    double radius;
    bool inside;  // grains are inside of it
    Vector velocity;
    Vector spin;  // about the point; leaves the shape where it is
  };

  int read_own(const std::vector<std::string>& words, std::size_t at) override;
  Wall& last_wall(const std::string& word);
  void set_spin(Wall& wall, const Vector& spin);
  Vector read_vector(const std::vector<std::string>& words, std::size_t at);
  void find() override;
  Vector center(const Wall& wall) const;
  ilaw::shapes::surface surface(const Wall& wall, const Vector& x) const;
  Vector velocity(const Wall& wall, int i, const Vector& nearest, double ahead) const;

  std::vector<Wall> walls_;
};

}  // namespace LAMMPS_NS

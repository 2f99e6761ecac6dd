// solids.hpp - solid bodies in 3D: boxes, and bodies with meshes from files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/mesh_body.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace ilaw::host {

struct MeshSetup {
  std::string name;
  MeshData mesh;
  MeshTopology topology;
  Eigen::Vector3d offset, velocity;  // offset: added to the positions of the mesh
  Material material;
  Element element;
};

// Each body with its nodes in the order of its mesh. A body "m" has the sets "m" and "m.<set>" of its
// topology.
class Solids : public Model {
 public:
  explicit Solids(const std::vector<MeshSetup>& bodies);

  bool has_internal_forces() const override { return true; }
  bool is_linear() const override;
  void add_internal_forces(const Dofs& u, Dofs& force) const override;
  double potential(const Dofs& u) const override;
  std::vector<Eigen::Matrix3d> stresses(const Dofs& u) const override;
  std::vector<VolumeElement> volume_elements() const override;
  double critical_step() const override { return *std::min_element(steps_.begin(), steps_.end()); }
  bool critical_step_is_exact() const override { return false; }

  double critical_step_of(std::size_t body) const { return steps_[body]; }

 private:
  std::vector<MeshBody> bodies_;
  std::vector<double> steps_;  // critical, by body
};

}  // namespace ilaw::host

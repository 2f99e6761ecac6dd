// solids.hpp - solid bodies in 3D: boxes of blocks.hpp, and bodies with meshes from files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "model/blocks.hpp"
#include "model/mesh_body.hpp"

#include <optional>
#include <string>
#include <vector>

namespace ilaw::host {

struct MeshSetup {
  std::string name;
  MeshData mesh;
  MeshTopology topology;
  Eigen::Vector3d offset, velocity;  // offset: added to the positions of the file
  Material material;
  Element element;
};

// Boxes first, then meshes, each with its nodes in the order of its file. A mesh "m" has the sets "m" and
// "m.<set>" of its topology.
class Solids : public Model {
 public:
  Solids(const std::vector<BlockSetup>& blocks, const std::vector<MeshSetup>& meshes);

  bool has_internal_forces() const override { return true; }
  bool is_linear() const override;
  void add_internal_forces(const Dofs& u, Dofs& force) const override;
  double potential(const Dofs& u) const override;
  std::vector<Eigen::Matrix3d> stresses(const Dofs& u) const override;
  double critical_step() const override { return critical_step_; }
  bool critical_step_is_exact() const override { return false; }

  double critical_step_of_mesh(std::size_t mesh) const { return steps_[mesh]; }

 private:
  void add_cells();

  std::optional<Blocks> blocks_;  // without blocks: none
  std::vector<MeshBody> bodies_;
  std::vector<double> steps_;  // critical, by mesh
  double critical_step_;
};

}  // namespace ilaw::host

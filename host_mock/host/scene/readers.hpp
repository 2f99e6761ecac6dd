// readers.hpp - the parts of a scene, a reader each. All throw SceneError at the pointer of a mistake.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace ilaw::host {

class Counterpart;
class Interface;
class Load;
class Model;
class ThermalModel;
struct ForceSetup;
struct InterfaceSetup;
struct NodeSet;
struct Scene;
struct Spring;

// "/model": the bodies. meshes: what was read of files, as describe_meshes has it.
std::unique_ptr<Model> read_model(const nlohmann::json& model, const std::filesystem::path& scene_file,
                                  nlohmann::json& meshes);
// "/sets": a name for some nodes, beside those that the model has.
void read_sets(const nlohmann::json& sets, Model& model);
// "/initial": displacements of nodes at time 0, on top of those that the bodies have.
void read_initial(const nlohmann::json& initial, Model& model);
// "/springs": springs and dampers, one between each pair of nodes. Adds warnings.
std::vector<Spring> read_springs(const nlohmann::json& springs, const Model& model,
                                 std::vector<std::string>& warnings);
// "/time": the step and the number of steps, into a scene whose model was read.
void read_time(const nlohmann::json& time, Scene& scene);
// A load: what acts on the bodies from outside.
std::unique_ptr<Load> read_load(const nlohmann::json& load, const Model& model, const std::string& pointer);

// "/interfaces" of a scene whose model and loads were read: their nodes, counterparts and laws. Behind them
// come edge rows, an interface for each one with averaged constraints whose law cannot pull: nodes on the
// border and on sharp edges of the main face against the facets of the secondary one.
void read_interfaces(Scene& scene);
// "obstacle" or "against" of an interface between its own nodes and that.
std::unique_ptr<Counterpart> read_counterpart(const nlohmann::json& interface, const NodeSet& own,
                                              const Model& model, const std::string& pointer);
// Temperatures, from the `thermal` of the bodies; null where none has it.
std::shared_ptr<const ThermalModel> read_thermal(const nlohmann::json& given, const Model& model);
// Throws where a node has no temperature.
void require_temperatures(const std::vector<int>& nodes, const Model& model, const std::string& pointer);
// The temperatures that an interface hands to its law, where its nodes have any.
void read_contact_heat(const nlohmann::json& interface, const Scene& scene, const std::string& pointer,
                       InterfaceSetup& setup);
// Throws where the law reads the temperature of an obstacle that has none, or one of "/fields" beside that of
// a body.
void check_temperatures_read(const Interface& interface, const Scene& scene, const std::string& pointer);
// Throws where two loads hold a node at different temperatures.
void check_held_temperatures(const Scene& scene);

// "/output/forces": the resultants that a scene asks for, by names of interfaces, of loads, of springs, or of
// sets that motions drive. The rest of the scene has been read.
std::vector<ForceSetup> read_forces(const nlohmann::json& forces, const Scene& scene);

}  // namespace ilaw::host

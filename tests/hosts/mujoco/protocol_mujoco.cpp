// A host of api/mujoco for the protocols of ilaw.protocols: a sphere on three slide joints, which does not
// turn, above a plane at rest. Usage: protocol_mujoco FILE. Prints displacement, velocity and the sum of the
// impulses.
// SPDX-License-Identifier: BSD-3-Clause
#include <ilaw_mujoco.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using ilaw::mujoco::stepper;

struct Protocol {
  std::string law;
  ilaw::parameters parameters;
  std::map<std::string, std::vector<double>> numbers;
  double operator[](const char* name) const { return numbers.at(name).front(); }
};

Protocol read(const char* path) {
  Protocol read;
  std::ifstream file(path);
  for (std::string line, name; std::getline(file, line);) {
    std::istringstream words(line);
    words >> name;
    if (name == "law") words >> read.law;
    std::string parameter;
    if (name == "parameter") words >> parameter;
    for (double number = 0.0; words >> number;)
      if (parameter.empty())
        read.numbers[name].push_back(number);
      else
        read.parameters.number(parameter, number);
  }
  return read;
}

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;

// Contacts are seen in the whole motion, hence the margin.
Model model_of(const Protocol& protocol, const std::string& path) {
  const std::vector<double>& x = protocol.numbers.at("position");
  const double radius = std::max(10 * x[2], 1.0);
  std::ofstream file(path);
  file.precision(17);
  file << "<mujoco><option gravity='0 0 0' timestep='" << protocol["step"] << "'/><default><geom margin='"
       << radius << "' gap='" << radius
       << "'/></default><worldbody><geom type='plane' size='0 0 1'/><body pos='" << x[0] << ' ' << x[1] << ' '
       << x[2] + radius << "'><joint type='slide' axis='1 0 0'/>"
       << "<joint type='slide' axis='0 1 0'/><joint type='slide' axis='0 0 1'/>"
       << "<inertial pos='0 0 0' diaginertia='1 1 1' mass='" << protocol["mass"]
       << "'/><geom type='sphere' size='" << radius << "'/></body></worldbody></mujoco>";
  file.close();
  char message[1000] = "";
  Model model(mj_loadXML(path.c_str(), nullptr, message, sizeof message), mj_deleteModel);
  if (!model) throw std::runtime_error(message);
  return model;
}

void run(const Protocol& protocol, const std::string& path) {
  const Model model = model_of(protocol, path);
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(model.get()), mj_deleteData);
  std::copy_n(protocol.numbers.at("velocity").begin(), 3, data->qvel);
  std::copy_n(protocol.numbers.at("force").begin(), 3, data->qfrc_applied);
  ilaw::mujoco::options options;
  options.area = protocol["area"];
  options.most_iterations = 100;
  options.tolerance = 1e-15;
  const auto create = [&] {
    return std::make_unique<stepper>(model.get(), protocol.law, protocol.parameters, options);
  };
  std::unique_ptr<stepper> host = create();
  double moved[3] = {}, sum[3] = {};
  for (int n = 0; n <= static_cast<int>(protocol["steps"]); ++n) {
    std::copy_n(data->qpos, 3, moved);
    n == 0 ? host->start(data.get()) : host->step(data.get());
    for (const ilaw::mujoco::contact_memory& contact : host->memory())
      for (std::size_t c = 0; c < 3; ++c) sum[c] += contact.impulse[c];
    if (n > 0 && n == static_cast<int>(protocol["restart"])) {
      std::vector<ilaw::mujoco::contact_memory> stored = host->memory();
      host = create();
      host->recall(std::move(stored));
    }
  }
  for (const double* vector : {static_cast<const double*>(moved), static_cast<const double*>(data->qvel),
                               static_cast<const double*>(sum)})
    std::printf("%.17g %.17g %.17g\n", vector[0], vector[1], vector[2]);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) throw std::runtime_error("usage: protocol_mujoco FILE");
  run(read(argv[1]), argv[1] + std::string(".xml"));
} catch (const std::exception& error) {
  std::fprintf(stderr, "protocol_mujoco: %s\n", error.what());
  return 1;
}

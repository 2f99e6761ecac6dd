// Hashes of the states in which scenes end, by the host without VTK: for processors under an emulator. A line
// for each scene, "name,hash".
#include "results/state_hash.hpp"
#include "scene/read_meshes.hpp"
#include "scene/scene.hpp"
#include "step/integrator.hpp"

#include <cstdio>
#include <exception>

namespace ilaw::host {

MeshData read_mesh_file(const std::filesystem::path& file) {
  throw MeshError("found " + file.string() + ", expected no file of a mesh without VTK");
}

namespace {

void run(const std::filesystem::path& file) {
  Scene scene = read_scene(file);
  Integrator integrator(*scene.model, scene.loads, scene.interfaces, scene.dt, scene.prestress);
  integrator.start();
  while (integrator.steps() < scene.steps) integrator.step();
  std::printf("%s,%s\n", file.stem().c_str(), state_hash(scene, integrator).c_str());
  std::fflush(stdout);
}

}  // namespace
}  // namespace ilaw::host

int main(int count, char** files) {
  int code = 0;
  for (int k = 1; k < count; ++k) try {
      ilaw::host::run(files[k]);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", files[k], error.what());
      code = 1;
    }
  return code;
}

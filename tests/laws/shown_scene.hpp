// shown_scene.hpp - a scene that stands beside its law, run step by step to see that it shows what its text
// says.
#pragma once

#include "host/host_runner.hpp"

namespace ilaw::host::testing {

struct ShownScene : Simulation {
  explicit ShownScene(const char* name) : Simulation(read_scene(scene_files::named(name))) {}

  template <class Look>
  void run(Look look) {
    while (integrator.steps() < scene.steps) {
      integrator.step();
      look();
    }
  }
};

}  // namespace ilaw::host::testing

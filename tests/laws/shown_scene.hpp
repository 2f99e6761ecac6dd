// shown_scene.hpp - a scene that stands beside its law, run step by step to see that it shows what its text
// says.
#pragma once

#include "host/host_runner.hpp"

namespace ilaw::host::testing {

struct ShownScene {
  explicit ShownScene(const char* name)
      : scene((setenv("ILAW_PATH", ILAW_PLUGIN_FOLDER, 1), read_scene(scene_files::named(name)))),
        integrator(integrator_of(scene)) {}

  template <class Look>
  void run(Look look) {
    while (integrator.steps() < scene.steps) {
      integrator.step();
      look();
    }
  }

  Scene scene;
  Integrator integrator;
};

}  // namespace ilaw::host::testing

// twins.hpp - the law of twin.c and twin.cpp, called without the loader's help.
#pragma once

#include "support/law_runner.hpp"

#include <functional>

namespace ilaw::testing {

inline const ilaw::library& twin(const std::string& made_with) {
  static const ilaw::library c(ILAW_TWINS "/twin_c.so"), kit(ILAW_TWINS "/twin_kit.so");
  return made_with == "c" ? c : kit;
}

struct Created {
  std::int32_t code;
  std::string message;
  ilaw_instance* instance = nullptr;
};

// create, whose setup may be null or broken.
inline Created create(const std::string& made_with, const ilaw_setup* setup, const char* id = "twin") {
  char message[300] = "untouched";
  Created created{};
  created.code = twin(made_with).law("twin")->create(id, setup, &created.instance, message, sizeof message);
  created.message = message;
  return created;
}

// Both laws with the same parameters.
class Twins {
 public:
  explicit Twins(const Parameters& parameters, std::uint32_t numbers = ILAW_NUMBERS_DOUBLE) {
    for (const std::string made_with : {"c", "kit"}) {
      SetupBuilder setup(parameters);
      setup.setup.numbers = numbers;
      const Created created = create(made_with, &setup.setup);
      EXPECT_EQ(created.code, ILAW_OK) << created.message;
      EXPECT_EQ(created.message, "");
      instances_[made_with] = created.instance;
    }
  }
  ~Twins() {
    for (const auto& [made_with, instance] : instances_) twin(made_with).law("twin")->destroy(instance);
  }
  Twins(const Twins&) = delete;
  Twins& operator=(const Twins&) = delete;

  const ilaw_instance* of(const std::string& made_with) const { return instances_.at(made_with); }

 private:
  std::map<std::string, ilaw_instance*> instances_;
};

}  // namespace ilaw::testing

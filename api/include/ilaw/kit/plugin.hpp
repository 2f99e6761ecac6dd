// plugin.hpp - the entry of a law library, made from its laws.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#ifndef ILAW_BUILDING_PLUGIN
#define ILAW_BUILDING_PLUGIN
#endif
#include <ilaw/ext/draft/profile.h>
#include <ilaw/kit/detail/checked.hpp>
#include <ilaw/kit/detail/evaluate.hpp>

namespace ilaw::kit::inline ILAW_KIT_LEVEL {

// One node by a form of the law, with the same bits as in a pack: for a step that chooses its form.
using detail::step_alone;

}  // namespace ilaw::kit

namespace ilaw::kit::inline ILAW_KIT_LEVEL::detail {

// The walks of this level, in the order of the laws.
template <class... Laws>
inline constexpr ilaw_kit_walk walks[] = {walk_batch<Laws>...};

// The place of a law in its library is not known to the law, so create is made per place.
template <std::size_t Place, class Law>
ilaw_result ILAW_CALL create_at(const char* id, const ilaw_setup* setup, ilaw_instance** result, char* text,
                                std::size_t text_size) {
  const std::int32_t code = create<Law>(id, setup, result, text, text_size);
  if (code == ILAW_OK)
    if (const ilaw_kit_walk* best = best_walks())
      reinterpret_cast<instance<Law>*>(*result)->walk = best[Place];
  return code;
}

// The level whose walks an instance uses.
template <std::size_t Place, class Law>
const char* ILAW_CALL instruction_set_at(const ilaw_instance* opaque) {
  [[maybe_unused]] const ilaw_kit_walk walk = of<Law>(opaque).walk;
#if defined(ILAW_KIT_OTHER_LEVELS)
  if (walk && walk == ilaw_kit_walks_v4()[Place]) return "v4";
  if (walk && walk == ilaw_kit_walks_v3()[Place]) return "v3";
#endif
  return "baseline";
}

template <std::size_t Place, class Law>
inline constexpr ilaw_profile profile{.struct_size = sizeof(ilaw_profile),
                                      .reserved = 0,
                                      .instruction_set = instruction_set_at<Place, Law>,
                                      .evaluate_counting = evaluate_counting<Law>};

// What the law has under names besides: what all laws of the kit have, and what its static member
// extension(const char*) knows.
template <std::size_t Place, class Law>
const void* ILAW_CALL extension_at(const char* name) {
  if (name && std::strcmp(name, ILAW_PROFILE) == 0) return &profile<Place, Law>;
  if constexpr (requires { Law::extension(name); })
    return Law::extension(name);
  else
    return nullptr;
}

template <std::size_t Place, class Law>
inline constexpr ilaw_law abi_law{.struct_size = sizeof(ilaw_law),
                                  .dimensions = Law::card.dimensions,
                                  .delassus_forms = Law::card.delassus_forms,
                                  .frames = ILAW_FRAME_LOCAL | ILAW_FRAME_GLOBAL,
                                  .numbers = ILAW_NUMBERS_DOUBLE | ILAW_NUMBERS_FLOAT,
                                  .inputs = Law::card.inputs | ILAW_INPUT_NORMAL | ILAW_INPUT_TANGENT,
                                  .outputs = ILAW_OUTPUT_VELOCITY | ILAW_OUTPUT_STATUS | ILAW_OUTPUT_ENERGY,
                                  .capabilities = abi_capabilities(Law::card.capabilities),
                                  .permissions = least_permissions<Law>(),
                                  .reserved = 0,
                                  .id = Law::card.id,
                                  .title = Law::card.title,
                                  .doc = Law::card.doc,
                                  .references = Law::references,
                                  .parameters = description<Law>::parameter_pointers.data(),
                                  .state_variables = description<Law>::state_variable_pointers.data(),
                                  .reference_count = std::size(Law::references),
                                  .parameter_count = parameter_count<Law>,
                                  .state_variable_count = state_variable_count<Law>,
                                  .amount_count = 0,
                                  .amounts = nullptr,
                                  .create = create_at<Place, Law>,
                                  .destroy = destroy<Law>,
                                  .info = info<Law>,
                                  .initialise = initialise<Law>,
                                  .evaluate = evaluate<Law>,
                                  .extension = extension_at<Place, Law>};

// The description of a library with these laws; Checked: whether all of them are laws.
template <bool Checked, class... Laws>
class library {
 public:
  static const ilaw_plugin* describe(const char* name, const char* version, const char* vendor,
                                     const char* licence) {
    static const ilaw_plugin plugin{.struct_size = sizeof(ilaw_plugin),
                                    .abi_major = ILAW_ABI_MAJOR,
                                    .abi_minor = ILAW_ABI_MINOR,
                                    .name = name,
                                    .version = version,
                                    .vendor = vendor,
                                    .licence = licence,
                                    .laws = pointers.data(),
                                    .law_count = sizeof...(Laws),
                                    .reserved = 0,
                                    .extension = nullptr};
    return &plugin;
  }

 private:
  template <std::size_t... Places>
  static constexpr std::array<const ilaw_law*, sizeof...(Laws)> all(std::index_sequence<Places...>) {
    return {&abi_law<Places, Laws>...};
  }
  static constexpr auto pointers = all(std::index_sequence_for<Laws...>{});
};
template <class... Laws>
class library<false, Laws...> {
 public:
  static const ilaw_plugin* describe(const char*, const char*, const char*, const char*) { return nullptr; }
};

template <class... Laws>
using library_of = library<(checked<Laws>() && ...), Laws...>;

}  // namespace ilaw::kit::detail

// ILAW_PLUGIN(name, version, vendor, licence, Law...) makes the one exported symbol of a law library; at the
// other levels, the hidden one that gives their walks.
#if defined(ILAW_KIT_WALKS)
#define ILAW_PLUGIN(name, version, vendor, licence, ...) \
  extern "C" const ilaw_kit_walk* ILAW_KIT_WALKS() { return ilaw::kit::detail::walks<__VA_ARGS__>; }
#else
#define ILAW_PLUGIN(name, version, vendor, licence, ...)                                         \
  extern "C" ILAW_EXPORT const ilaw_plugin* ILAW_CALL ILAW_ENTRY(void) {                         \
    return ilaw::kit::detail::library_of<__VA_ARGS__>::describe(name, version, vendor, licence); \
  }
#endif

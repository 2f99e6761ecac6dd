// scene_parts.hpp - scenes put together from their parts.
#pragma once

#include <nlohmann/json.hpp>

#include <array>
#include <vector>

namespace ilaw::host::testing {

using nlohmann::json;
using Numbers = std::vector<double>;
using Triple = std::array<double, 3>;

inline json point(double mass, const Numbers& position, const Numbers& velocity = {}) {
  json made = {{"mass", mass}, {"position", position}};
  if (!velocity.empty()) made["velocity"] = velocity;
  return made;
}
inline json bar(const char* name, double start, double length, int elements, double young, double density,
                double velocity = 0.0) {
  return {{"name", name},   {"start", start},     {"length", length},    {"elements", elements},
          {"young", young}, {"density", density}, {"velocity", velocity}};
}
inline json elastic(double young, double poisson, double density) {
  return {{"type", "linear"}, {"young", young}, {"poisson", poisson}, {"density", density}};
}
inline json block(const char* name, const Triple& corner, const Triple& size,
                  const std::array<int, 3>& elements, const json& material, const Triple& velocity = {}) {
  return {{"name", name},         {"corner", corner},     {"size", size},
          {"elements", elements}, {"material", material}, {"velocity", velocity}};
}

inline json plane(const Numbers& through, const Numbers& normal) {
  return {{"type", "plane"}, {"point", through}, {"normal", normal}};
}
// A plane through the origin, up the last axis.
inline json ground(std::size_t dimension) {
  Numbers normal(dimension);
  normal.back() = 1.0;
  return plane(Numbers(dimension), normal);
}
inline json law_on(const json& nodes, const json& obstacle, const char* law,
                   const json& parameters = json::object()) {
  return {{"nodes", nodes}, {"obstacle", obstacle}, {"law", law}, {"parameters", parameters}};
}
inline json law_between(const json& nodes, const json& against, const char* law,
                        const json& parameters = json::object()) {
  return {{"nodes", nodes}, {"against", against}, {"law", law}, {"parameters", parameters}};
}
inline json named(const char* name, json part) {
  part["name"] = name;
  return part;
}
inline json gravity(const Numbers& acceleration) {
  return {{"type", "gravity"}, {"acceleration", acceleration}};
}

// Scenes; a time that is left out is the test's own.
inline json scene_of_points(const std::vector<json>& points, const std::vector<json>& interfaces,
                            const std::vector<json>& loads = {}) {
  const std::size_t dimension = points.front().at("position").size();
  return {{"model", {{"type", "points"}, {"dimension", dimension}, {"points", points}}},
          {"interfaces", interfaces},
          {"loads", loads}};
}
inline json scene_of_bars(const std::vector<json>& bars, const std::vector<json>& interfaces,
                          const std::vector<json>& loads = {}) {
  return {{"model", {{"type", "bars"}, {"bars", bars}}}, {"interfaces", interfaces}, {"loads", loads}};
}
inline json scene_of_blocks(const std::vector<json>& blocks, const std::vector<json>& interfaces) {
  return {{"model", {{"type", "blocks"}, {"blocks", blocks}}}, {"interfaces", interfaces}};
}
inline json scene_of_blocks(const std::vector<json>& blocks, const char* interfaces) {
  return scene_of_blocks(blocks, json::parse(interfaces));
}
inline json until(double end, double dt, json scene) {
  scene["time"] = {{"dt", dt}, {"end", end}};
  return scene;
}
inline json until_at_cfl(double end, double cfl, json scene) {
  scene["time"] = {{"cfl", cfl}, {"end", end}};
  return scene;
}

}  // namespace ilaw::host::testing

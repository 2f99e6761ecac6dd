// The functions of search.h: structs of any version in, no exception out.
// SPDX-License-Identifier: BSD-3-Clause
#include "finder.hpp"
#include "sizes.hpp"

#include <new>
#include <stdexcept>

struct ilaw_facets {
  ilaw::search::Finder finder;
  std::uint32_t dimension, corner_count;
};

namespace {

using namespace ilaw;

bool is_there(const ilaw_input& input) { return input.values || input.floats; }

bool are_nodes(const int32_t* nodes, int64_t count, const ilaw_facets_setup& setup) {
  for (int64_t k = 0; k < count; ++k) {
    const int64_t node = int64_t{nodes[k]} - setup.index_base;
    if (node < 0 || node >= setup.node_count) return false;
  }
  return true;
}

bool is_right(const ilaw_facets_setup& setup) {
  constexpr int64_t most = int64_t{1} << 30;
  const bool has_corners = setup.dimension == 2   ? setup.corner_count == 2
                           : setup.dimension == 3 ? setup.corner_count == 3 || setup.corner_count == 4
                                                  : false;
  if (!has_corners || !setup.facets || setup.facet_count < 1 || setup.facet_count > most) return false;
  if (setup.point_count < 0 || setup.point_count > most || (setup.point_count > 0 && !setup.points))
    return false;
  return is_there(setup.position) && are_nodes(setup.facets, setup.facet_count * setup.corner_count, setup) &&
         are_nodes(setup.points, setup.point_count, setup);
}

double* place_in(const ilaw_output& output, int64_t k) { return output.values + k * output.node_stride; }

void write(const ilaw_output& output, int64_t k, const double* values, uint32_t count) {
  if (!output.values) return;
  for (uint32_t c = 0; c < count; ++c) place_in(output, k)[c * output.component_stride] = values[c];
}

struct Reading {
  double gap, approach;
  int32_t place;
};

// A point beside a facet is nearest to its edge. Behind the plane of the facet it is behind the surface, but
// at a border it has to come over the facet before it meets it; in front, it has the distance to go.
Reading read(const search::Pair& pair, double rim, double rounding) {
  const bool is_on_rim = pair.is_at_border && pair.beside <= rim && pair.along >= -rim;
  const bool is_behind = !pair.is_at_border && pair.along < 0.0;
  if (pair.beside <= rounding || is_on_rim || is_behind)
    return {pair.along, pair.along > 0.0 ? pair.along : 0.0, ILAW_PLACE_OVER};
  const double distance = pair.at.distance, aside = pair.beside - (rim > rounding ? rim : rounding);
  const double approach = pair.along > 0.0 ? distance : aside > 0.0 ? aside : 0.0;
  return {distance, approach, pair.is_at_border ? ILAW_PLACE_BEYOND : ILAW_PLACE_BESIDE};
}

}  // namespace

ilaw_result ILAW_CALL ilaw_facets_create(const ilaw_facets_setup* setup, ilaw_facets** search) {
  if (!search) return ILAW_INVALID_ARGUMENT;
  *search = nullptr;
  if (!sized::is_complete(setup)) return ILAW_INVALID_ARGUMENT;
  const ilaw_facets_setup known = sized::read(setup);
  if (!is_right(known)) return ILAW_INVALID_ARGUMENT;
  try {
    *search = new ilaw_facets{ilaw::search::Finder(known), known.dimension, known.corner_count};
  } catch (const std::bad_alloc&) {
    return ILAW_OUT_OF_MEMORY;
  } catch (const std::length_error&) {
    return ILAW_OUT_OF_MEMORY;
  }
  return ILAW_OK;
}

void ILAW_CALL ilaw_facets_destroy(ilaw_facets* search) { delete search; }

ilaw_result ILAW_CALL ilaw_facets_update(ilaw_facets* search, const ilaw_facets_positions* positions) {
  if (!search || !sized::is_complete(positions)) return ILAW_INVALID_ARGUMENT;
  const ilaw_facets_positions known = sized::read(positions);
  if (!is_there(known.position)) return ILAW_INVALID_ARGUMENT;
  search->finder.update({search->dimension, known.position, known.displacement});
  return ILAW_OK;
}

ilaw_result ILAW_CALL ilaw_facets_near(ilaw_facets* search, ilaw_facets_nearby* nearby) {
  if (!search || !sized::is_complete(nearby)) return ILAW_INVALID_ARGUMENT;
  ilaw_facets_nearby known = sized::read(nearby);
  if (!(known.reach >= 0.0)) return ILAW_INVALID_ARGUMENT;
  search->finder.find_near(known);
  sized::write(nearby, known);
  return ILAW_OK;
}

ilaw_result ILAW_CALL ilaw_facets_pairs(ilaw_facets* search, const ilaw_facets_pairs_of* pairs) {
  if (!search || !sized::is_complete(pairs)) return ILAW_INVALID_ARGUMENT;
  const ilaw_facets_pairs_of asked = sized::read(pairs);
  const auto points = static_cast<int64_t>(search->finder.point_count());
  if (asked.count < 0 || (!asked.points && asked.count > points)) return ILAW_INVALID_ARGUMENT;
  for (int64_t i = 0; asked.points && i < asked.count; ++i)
    if (asked.points[i] < 0 || asked.points[i] >= points) return ILAW_INVALID_ARGUMENT;
  const double rounding = search->finder.rounding_rim();
  int64_t looked_at = 0;
  for (int64_t i = 0; i < asked.count; ++i) {
    const int64_t point = asked.points ? asked.points[i] : i;
    const search::Pair& pair = search->finder.pair_of(static_cast<std::size_t>(point), looked_at);
    const double rim = asked.rim.values ? asked.rim.values[i * asked.rim.node_stride] : 0.0;
    const Reading found = read(pair, rim, rounding);
    if (asked.facet) asked.facet[i] = pair.facet;
    if (asked.place) asked.place[i] = pair.facet < 0 ? ILAW_PLACE_BEYOND : found.place;
    write(asked.gap, i, pair.facet < 0 ? &pair.at.distance : &found.gap, 1);
    write(asked.normal, i, &pair.at.normal.x, search->dimension);
    write(asked.weights, i, pair.at.weights.data(), search->corner_count);
    write(asked.approach, i, &found.approach, 1);
  }
  search->finder.add_counts(asked.count, looked_at);
  return ILAW_OK;
}

ilaw_result ILAW_CALL ilaw_facets_overlaps(const ilaw_facets* search,
                                           const ilaw_facets_overlaps_of* overlaps) {
  if (!search || !sized::is_complete(overlaps)) return ILAW_INVALID_ARGUMENT;
  const ilaw_facets_overlaps_of asked = sized::read(overlaps);
  const auto points = static_cast<int64_t>(search->finder.point_count());
  const bool is_right = asked.count >= 0 && asked.capacity >= 0 && asked.distance >= 0.0 && asked.first &&
                        asked.corner_count > 0 && (asked.points || asked.count == 0) &&
                        (asked.facets || asked.capacity == 0);
  if (!is_right) return ILAW_INVALID_ARGUMENT;
  for (int64_t k = 0; k < asked.count * asked.corner_count; ++k)
    if (asked.points[k] < 0 || asked.points[k] >= points) return ILAW_INVALID_ARGUMENT;
  int64_t end = 0;
  for (int64_t i = 0; i < asked.count; ++i) {
    asked.first[i] = end;
    const int64_t left = asked.capacity > end ? asked.capacity - end : 0;
    end += search->finder.find_overlaps(asked.points + i * asked.corner_count, asked.corner_count,
                                        asked.distance, left > 0 ? asked.facets + end : asked.facets, left);
  }
  asked.first[asked.count] = end;
  return ILAW_OK;
}

ilaw_result ILAW_CALL ilaw_facets_count(const ilaw_facets* search, ilaw_facets_counts* counts) {
  if (!search || !sized::cleared(counts)) return ILAW_INVALID_ARGUMENT;
  ilaw_facets_counts known{};
  search->finder.read_counts(known);
  sized::write(counts, known);
  return ILAW_OK;
}

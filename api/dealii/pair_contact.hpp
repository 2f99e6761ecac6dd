// pair_contact.hpp - an interface law between two deformable blocks, each split between the ranks of MPI.
// Every rank gathers the surfaces of both blocks and solves the whole interface, with the same bits as all
// others.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ilaw/coupled.h>
#include <ilaw/search.h>
#include <ilaw/arrays.hpp>
#include <ilaw/loader.hpp>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "block.hpp"

// A side of a block on every rank, in an order that does not depend on the number of ranks.
class block_side {
 public:
  using facet_nodes = std::array<std::int32_t, 4>;

  block_side(const block& body, boundary_id which) {
    const distributed_vector areas = body.areas(which);
    const auto corners = gather(body.facets(which));
    for (const auto& facet : corners) places_.insert(places_.end(), facet.begin(), facet.end());
    std::sort(places_.begin(), places_.end(), is_before);
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    for (const auto& facet : corners) facets_.push_back(canonical(facet));
    std::sort(facets_.begin(), facets_.end());

    std::vector<std::array<double, 2>> own;
    for (const block::node& at : body.nodes()) {
      if (areas.local_element(at.dof) <= 0.0) continue;
      dofs_.push_back(at.dof);
      own_.push_back(static_cast<std::size_t>(index_of(at.place)));
      own.push_back({{areas.local_element(at.dof), body.inverse_mass().local_element(at.dof)}});
    }
    index_of_gathered_ = gather(own_);
    for (const auto& [area, inverse_mass] : gather_nodes(own)) {
      area_.push_back(area);
      inverse_mass_.push_back(inverse_mass);
    }
  }

  std::size_t size() const { return places_.size(); }
  const std::vector<Point<3>>& places() const { return places_; }
  const std::vector<double>& area() const { return area_; }
  const std::vector<double>& inverse_mass() const { return inverse_mass_; }
  const std::vector<facet_nodes>& facets() const { return facets_; }  // from outside counterclockwise
  const std::vector<unsigned>& dofs() const { return dofs_; }         // of the nodes of this rank
  const std::vector<std::size_t>& own() const { return own_; }        // and their places in the arrays above

  // Values of the nodes of this rank -> of all nodes.
  template <typename Value>
  std::vector<Value> gather_nodes(const std::vector<Value>& own) const {
    const std::vector<Value> gathered = gather(own);
    std::vector<Value> all(gathered.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[index_of_gathered_[k]] = gathered[k];
    return all;
  }

 private:
  static bool is_before(const Point<3>& a, const Point<3>& b) {
    return std::lexicographical_compare(a.begin_raw(), a.end_raw(), b.begin_raw(), b.end_raw());
  }
  template <typename Value>
  static std::vector<Value> gather(const std::vector<Value>& own) {
    std::vector<Value> all;
    for (const auto& of_rank : dealii::Utilities::MPI::all_gather(MPI_COMM_WORLD, own))
      all.insert(all.end(), of_rank.begin(), of_rank.end());
    return all;
  }
  std::int32_t index_of(const Point<3>& place) const {
    return static_cast<std::int32_t>(std::lower_bound(places_.begin(), places_.end(), place, is_before) -
                                     places_.begin());
  }
  // The search takes the first of equally close facets, so that the order of facets and corners counts, too.
  facet_nodes canonical(const std::array<Point<3>, 4>& corners) const {
    facet_nodes facet{};
    std::transform(corners.begin(), corners.end(), facet.begin(),
                   [this](const Point<3>& place) { return index_of(place); });
    std::rotate(facet.begin(), std::min_element(facet.begin(), facet.end()), facet.end());
    return facet;
  }

  std::vector<Point<3>> places_;
  std::vector<facet_nodes> facets_;
  std::vector<unsigned> dofs_;
  std::vector<std::size_t> own_, index_of_gathered_;
  std::vector<double> area_, inverse_mass_;
};

// The nodes of the upper block's lower side meet the facets of the lower block's upper side.
class pair_contact {
 public:
  struct motion {
    const distributed_vector &u, &before;
    distributed_vector& v;  // without the interface, then with it
  };

  pair_contact(const block& upper, const block& lower, ilaw::interface law, double h)
      : sides_{{block_side(upper, block::lower_side), block_side(lower, block::upper_side)}},
        law_(std::move(law)),
        count_(sides_[0].size()) {
    for (const block_side& side : sides_)
      inverse_mass_.insert(inverse_mass_.end(), side.inverse_mass().begin(), side.inverse_mass().end());
    create_search();
    describe(h);
    if (law_.initialise(batch_) != ILAW_OK) throw std::runtime_error("initialise refused");
  }

  // Returns the work of the interface, of all ranks.
  double apply(const std::array<motion, 2>& blocks, double time) {
    nodes_.clear();
    for (std::size_t k = 0; k < 2; ++k) {
      const auto all = sides_[k].gather_nodes(own_rows(sides_[k], blocks[k]));
      nodes_.insert(nodes_.end(), all.begin(), all.end());
    }
    find_pairs();
    batch_.time = time;
    const double work = solve();
    std::size_t first = 0;
    for (std::size_t k = 0; k < 2; first += sides_[k++].size())
      for (std::size_t j = 0; j < sides_[k].dofs().size(); ++j)
        for (unsigned c = 0; c < 3; ++c)
          blocks[k].v.local_element(sides_[k].dofs()[j] + c) = nodes_[first + sides_[k].own()[j]][3 + c];
    return work;
  }

  const std::array<block_side, 2>& sides() const { return sides_; }

 private:
  using row = std::array<double, 9>;  // u, v, v before the step

  static std::vector<row> own_rows(const block_side& side, const motion& of) {
    std::vector<row> rows;
    for (const unsigned dof : side.dofs()) {
      row& at = rows.emplace_back();
      for (unsigned c = 0; c < 3; ++c) {
        at[c] = of.u.local_element(dof + c);
        at[3 + c] = of.v.local_element(dof + c);
        at[6 + c] = of.before.local_element(dof + c);
      }
    }
    return rows;
  }

  void create_search() {
    for (const block_side& side : sides_)
      for (const Point<3>& place : side.places()) places_.push_back({{place[0], place[1], place[2]}});
    nodes_.resize(places_.size());
    for (block_side::facet_nodes facet : sides_[1].facets()) {
      for (std::int32_t& node : facet) node += static_cast<std::int32_t>(count_);
      facets_.push_back(facet);
    }
    bodies_.resize(count_);
    std::iota(bodies_.begin(), bodies_.end(), 0);
    ilaw_facets_setup setup{};
    setup.struct_size = sizeof setup;
    setup.dimension = 3;
    setup.corner_count = 4;
    setup.node_count = static_cast<std::int64_t>(places_.size());
    setup.facet_count = static_cast<std::int64_t>(facets_.size());
    setup.facets = facets_.front().data();
    setup.point_count = static_cast<std::int64_t>(count_);
    setup.points = bodies_.data();
    setup.position = ilaw::input(places_.front().data(), 3, 1);
    ilaw_facets* made = nullptr;
    if (ilaw_facets_create(&setup, &made) != ILAW_OK)
      throw std::runtime_error("the search refuses the facets");
    search_.reset(made);
  }

  void find_pairs() {
    ilaw_facets_positions positions{};
    positions.struct_size = sizeof positions;
    positions.position = ilaw::input(places_.front().data(), 3, 1);
    positions.displacement = ilaw::input(nodes_.front().data(), 9, 1);
    std::vector<std::int32_t> facet(count_), place(count_);
    ilaw_facets_pairs_of pairs{};
    pairs.struct_size = sizeof pairs;
    pairs.count = static_cast<std::int64_t>(count_);
    pairs.rim = ilaw::input(&rim_, 0, 0);
    pairs.facet = facet.data();
    pairs.place = place.data();
    pairs.gap = ilaw::output(gap_.data(), 1, 0);
    pairs.normal = ilaw::output(normal_.data(), 3, 1);
    pairs.weights = ilaw::output(weights_.data(), 4, 1);
    if (ilaw_facets_update(search_.get(), &positions) != ILAW_OK ||
        ilaw_facets_pairs(search_.get(), &pairs) != ILAW_OK)
      throw std::runtime_error("the search refuses the positions");
    for (std::size_t k = 0; k < count_; ++k) {
      if (facet[k] < 0) throw std::runtime_error("a node of the interface has no finite place");
      counterparts_[k] = facets_[static_cast<std::size_t>(facet[k])];
      if (place[k] == ILAW_PLACE_BEYOND) gap_[k] = 1e3;  // beyond the border there is nothing to meet
    }
  }

  double solve() {
    ilaw_bodies bodies{};
    bodies.struct_size = sizeof bodies;
    bodies.dimension = 3;
    bodies.count = bodies.owned_count = static_cast<std::int64_t>(nodes_.size());
    bodies.inverse_mass = ilaw::input(inverse_mass_.data(), 1, 0);
    bodies.v_free = ilaw::input(&nodes_.front()[3], 9, 1);
    bodies.v_previous = ilaw::input(&nodes_.front()[6], 9, 1);
    bodies.velocity = ilaw::output(&nodes_.front()[3], 9, 1);
    std::vector<std::array<double, 3>> impulse(nodes_.size());
    bodies.impulse = ilaw::output(impulse.front().data(), 3, 1);
    ilaw_contacts contacts{};
    contacts.struct_size = sizeof contacts;
    contacts.delassus_form = ILAW_DELASSUS_SCALAR;
    contacts.law = &law_.law();
    contacts.instance = law_.instance();
    contacts.batch = &batch_;
    contacts.body = bodies_.data();
    contacts.counterpart = counterparts_.front().data();
    contacts.counterpart_count = 4;
    contacts.counterpart_weight = ilaw::input(weights_.data(), 4, 1);
    ilaw_coupled_options options{};
    options.struct_size = sizeof options;
    options.tolerance = 1e-14;
    const ilaw_contacts* groups[] = {&contacts};
    ilaw_coupled_report report{};
    report.struct_size = sizeof report;
    if (ilaw_coupled_solve(solver_.get(), &bodies, groups, 1, &options, &report) != ILAW_OK)
      throw std::runtime_error(report.reason ? report.reason : "the solver gave no reason");
    double work = 0.0;
    for (std::size_t k = 0; k < nodes_.size(); ++k)
      for (unsigned c = 0; c < 3; ++c) work += impulse[k][c] * 0.5 * (nodes_[k][3 + c] + nodes_[k][6 + c]);
    return work;
  }

  void describe(double h) {
    const auto state_size = static_cast<std::int64_t>(law_.info().state_size);
    for (auto* vectors : {&normal_, &impulse_}) vectors->assign(3 * count_, 0.0);
    gap_.assign(count_, 0.0);
    weights_.assign(4 * count_, 0.0);
    counterparts_.resize(count_);
    state_.assign(count_ * law_.info().state_size, 0.0);
    find_pairs();
    batch_.struct_size = sizeof batch_;
    batch_.node_count = static_cast<std::int64_t>(count_);
    batch_.velocity_step = batch_.position_step = h;
    batch_.gap = ilaw::input(gap_.data(), 1, 0);
    batch_.area = ilaw::input(sides_[0].area().data(), 1, 0);
    batch_.normal = ilaw::input(normal_.data(), 3, 1);
    batch_.state_in = ilaw::input(state_.data(), state_size, 1);
    batch_.state_out = ilaw::output(state_.data(), state_size, 1);
    batch_.impulse = ilaw::output(impulse_.data(), 3, 1);
  }

  struct destroyer {
    void operator()(ilaw_facets* search) const { ilaw_facets_destroy(search); }
    void operator()(ilaw_coupled* solver) const { ilaw_coupled_destroy(solver); }
  };
  static constexpr double rim_ = 1e-9;  // of rounding

  std::array<block_side, 2> sides_;
  ilaw::interface law_;
  std::unique_ptr<ilaw_coupled, destroyer> solver_{ilaw_coupled_create()};
  std::unique_ptr<ilaw_facets, destroyer> search_;
  std::size_t count_;  // nodes of the upper block, which come first
  ilaw_batch batch_{};
  std::vector<row> nodes_;
  std::vector<std::array<double, 3>> places_;
  std::vector<block_side::facet_nodes> facets_, counterparts_;
  std::vector<std::int32_t> bodies_;
  std::vector<double> inverse_mass_, gap_, normal_, weights_, impulse_, state_;
};

// SPDX-License-Identifier: BSD-3-Clause
#include "fix_ilaw.hpp"

#include <ilaw/arrays.hpp>

#include <atom.h>
#include <comm.h>
#include <error.h>
#include <force.h>
#include <modify.h>
#include <update.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string_view>

namespace LAMMPS_NS {
namespace {

constexpr int motion_size = 12;  // v_free, spin_free, v_previous, spin_previous
constexpr double inertia = 0.4;  // of a sphere, over m R^2
constexpr std::uint32_t default_sweeps = 20;
constexpr double max_sweeps = 1e6;
constexpr double default_tolerance = 1e-8;
enum { CLOSED, SWEEPS, RESIDUAL, OVERLAP, APPROACH, FRICTION, IMPACT, RUPTURE, STORED, OUTPUTS };

}  // namespace

FixIlaw::FixIlaw(LAMMPS* lammps, int narg, char** arg) : Fix(lammps, narg, arg) {
  if (narg < 4) refuse("expected a law after the style");
  law_ = arg[3];
  words_.assign(arg + 4, arg + narg);
  if (!atom->sphere_flag || !atom->rmass || !atom->omega || !atom->torque)
    refuse("needs atom_style sphere: grains with radius, mass and rotation");
  restart_global = restart_peratom = create_attribute = maxexchange_dynamic = 1;
  vector_flag = 1;
  size_vector = OUTPUTS;
  global_freq = 1;
  extvector = 0;
  comm_forward = motion_size;
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
}

FixIlaw::~FixIlaw() {
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
}

void FixIlaw::refuse(const std::string& why) { error->all(FLERR, "Fix " + std::string(style) + ": " + why); }

double FixIlaw::number(const std::vector<std::string>& words, std::size_t at) {
  char* end = nullptr;
  const double value = at < words.size() ? std::strtod(words[at].c_str(), &end) : 0.0;
  if (!end || *end != '\0' || words[at].empty()) refuse("expected a number after " + words[at - 1]);
  return value;
}

// Called by the styles, when they can read their own words.
void FixIlaw::read_words() {
  for (std::size_t at = 0; at < words_.size();) {
    if (words_[at] == "sweeps") {
      most_sweeps_ = number(words_, at + 1);
      if (!(most_sweeps_ >= 1.0 && most_sweeps_ <= max_sweeps && most_sweeps_ == std::floor(most_sweeps_)))
        refuse("sweeps is " + words_[at + 1] + "; expected a whole number from 1 to 1000000");
      at += 2;
    } else if (words_[at] == "tol") {
      tolerance_ = number(words_, at + 1);
      if (!(tolerance_ > 0.0 && std::isfinite(tolerance_)))
        refuse("tol is " + words_[at + 1] + "; expected a finite number above 0");
      at += 2;
    } else if (words_[at] == "area") {
      area_ = number(words_, at + 1);
      if (!(area_ >= 0.0 && std::isfinite(area_)))
        refuse("area is " + words_[at + 1] + "; expected a finite number, 0 or above");
      at += 2;
    } else if (const int own = read_own(words_, at); own > 0) {
      at += static_cast<std::size_t>(own);
    } else {
      if (at + 1 >= words_.size()) refuse("expected a value after " + words_[at]);
      parameters_.push_back({words_[at], words_[at + 1]});
      at += 2;
    }
  }
  std::string why;
  try {
    contacts_ = std::make_unique<ilaw::lammps::ContactSet>(law_, parameters_);
  } catch (const ilaw::error& refusal) {
    why = refusal.what();
  }
  if (!why.empty()) refuse(why);
}

int FixIlaw::setmask() { return FixConst::INITIAL_INTEGRATE | FixConst::POST_FORCE; }

void FixIlaw::init() {
  all_.clear();
  for (int i = 0; i < modify->nfix; ++i)
    if (auto* other = dynamic_cast<FixIlaw*>(modify->fix[i])) all_.push_back(other);
  check_run();
  check();
}

void FixIlaw::check_run() {
  if (force->newton_pair)
    refuse(
        "needs newton off: with newton on only one of two ranks finds a contact across their border, and "
        "the other does not know its impulse");
  if (std::strstr(update->integrate_style, "respa")) refuse("does not run with respa");
  check_integration();
  bool behind = false;
  for (int i = 0; i < modify->nfix; ++i) {
    if (modify->fix[i] == all_.back())
      behind = true;
    else if (behind && (modify->fmask[i] & FixConst::POST_FORCE))
      refuse("has to come after all fixes that add forces, gravity included, but fix " +
             std::string(modify->fix[i]->id) + " comes later");
  }
}

// The laws count on spins that change.
void FixIlaw::check_integration() {
  const char* without_spin = nullptr;
  for (int i = 0; i < modify->nfix; ++i) {
    const std::string_view moves = modify->fix[i]->style;
    if (moves.starts_with("nve/sphere")) return;
    if (moves.starts_with("nve")) without_spin = modify->fix[i]->id;
  }
  if (without_spin)
    refuse("needs grains that fix nve/sphere moves, but fix " + std::string(without_spin) +
           " does not rotate them");
}

// The most exact of what fixes ask for; those that say nothing leave it to the others.
ilaw_coupled_options FixIlaw::options() const {
  double sweeps = 0.0, tolerance = std::numeric_limits<double>::infinity();
  for (const FixIlaw* fix : all_) {
    sweeps = std::max(sweeps, fix->most_sweeps_);
    if (fix->tolerance_ > 0.0) tolerance = std::min(tolerance, fix->tolerance_);
  }
  ilaw_coupled_options options{};
  options.most_sweeps = sweeps > 0.0 ? static_cast<std::uint32_t>(sweeps) : default_sweeps;
  options.tolerance = std::isfinite(tolerance) ? tolerance : default_tolerance;
  return options;
}

// Forces of a time that was evaluated already, when a run goes on: another evaluate would lose a bounce and
// count a memory twice.
void FixIlaw::setup(int) {
  if (!leads()) return;
  if (std::none_of(all_.begin(), all_.end(), [](const FixIlaw* fix) { return fix->evaluated_; }))
    return evaluate(0.5 * update->dt);  // the first kick is half a one
  for (const FixIlaw* fix : all_)
    for (std::size_t i = 0; i < static_cast<std::size_t>(atom->nlocal); ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        atom->f[i][c] += fix->kept_[i][c];
        atom->torque[i][c] += fix->kept_[i][3 + c];
      }
}

void FixIlaw::initial_integrate(int) {
  evaluated_ = false;
  clock_ += update->dt;
  moved_time_ += update->dt;
}

void FixIlaw::post_force(int) {
  if (leads()) evaluate(update->dt);
}

void FixIlaw::evaluate(double velocity_step) {
  gather_bodies(velocity_step);
  for (FixIlaw* fix : all_) {
    fix->contacts_->clear(velocity_step);
    fix->find();
  }
  solve();
  add_forces(velocity_step);
  for (FixIlaw* fix : all_) {
    fix->tally();
    fix->evaluated_ = false;
  }
  store();
  evaluated_ = true;
}

void FixIlaw::gather_bodies(double velocity_step) {
  const auto count = static_cast<std::size_t>(atom->nlocal + atom->nghost);
  motion_.resize(motion_size * count);
  inverse_mass_.resize(count);
  inverse_inertia_.resize(count);
  ids_.assign(atom->tag, atom->tag + count);
  for (std::size_t i = 0; i < count; ++i) {
    inverse_mass_[i] = 1.0 / atom->rmass[i];
    inverse_inertia_[i] = 1.0 / (inertia * atom->rmass[i] * atom->radius[i] * atom->radius[i]);
    if (i >= static_cast<std::size_t>(atom->nlocal)) continue;
    double* motion = &motion_[motion_size * i];
    for (std::size_t c = 0; c < 3; ++c) {
      motion[c] = atom->v[i][c] + velocity_step * inverse_mass_[i] * atom->f[i][c] * force->ftm2v;
      motion[3 + c] =
          atom->omega[i][c] + velocity_step * inverse_inertia_[i] * atom->torque[i][c] * force->ftm2v;
      motion[6 + c] = atom->v[i][c];
      motion[9 + c] = atom->omega[i][c];
    }
  }
  forward(motion_.data(), motion_size);
}

void FixIlaw::solve() {
  const auto count = static_cast<std::int64_t>(inverse_mass_.size());
  after_.resize(6 * inverse_mass_.size());
  total_.resize(6 * inverse_mass_.size());
  ilaw_bodies bodies{};
  bodies.struct_size = sizeof bodies;
  bodies.dimension = 3;
  bodies.count = count;
  bodies.owned_count = atom->nlocal;
  if (!ids_.empty()) bodies.id = ids_.data();
  bodies.inverse_mass = ilaw::input(inverse_mass_.data(), 1, 0);
  bodies.inverse_inertia = ilaw::input(inverse_inertia_.data(), 1, 0);
  bodies.v_free = ilaw::input(motion_.data(), motion_size, 1);
  bodies.spin_free = ilaw::input(motion_.data() + 3, motion_size, 1);
  bodies.v_previous = ilaw::input(motion_.data() + 6, motion_size, 1);
  bodies.spin_previous = ilaw::input(motion_.data() + 9, motion_size, 1);
  bodies.velocity = ilaw::output(after_.data(), 6, 1);
  bodies.spin = ilaw::output(after_.data() + 3, 6, 1);
  bodies.impulse = ilaw::output(total_.data(), 6, 1);
  bodies.angular_impulse = ilaw::output(total_.data() + 3, 6, 1);

  ilaw_exchange exchange{};
  exchange.struct_size = sizeof exchange;
  exchange.context = this;
  // Impulses of ghosts are added at their owners, and the sums go back to the ghosts.
  exchange.sum_bodies = [](void* context, double* values, std::int64_t components) {
    auto* self = static_cast<FixIlaw*>(context);
    self->reverse(values, static_cast<int>(components));
    self->forward(values, static_cast<int>(components));
  };
  exchange.largest = [](void* context, double* values, std::int64_t n) {
    MPI_Allreduce(MPI_IN_PLACE, values, static_cast<int>(n), MPI_DOUBLE, MPI_MAX,
                  static_cast<FixIlaw*>(context)->world);
  };
  exchange.sum = [](void* context, double* values, std::int64_t n) {
    MPI_Allreduce(MPI_IN_PLACE, values, static_cast<int>(n), MPI_DOUBLE, MPI_SUM,
                  static_cast<FixIlaw*>(context)->world);
  };
  ilaw_coupled_options options = this->options();
  // Without it the solver knows that it has the whole system.
  if (comm->nprocs > 1 || atom->nghost > 0) options.exchange = &exchange;
  std::vector<const ilaw_contacts*> groups;
  for (FixIlaw* fix : all_) groups.push_back(fix->contacts_->describe(clock_, update->dt));
  std::string why;
  try {
    report_ = solver_.solve(bodies, groups, options);
  } catch (const ilaw::error& refusal) {
    why = refusal.what();
  }
  if (!why.empty()) refuse(why);
  if (report_.bad_count > 0) {
    const auto& contacts = *all_[static_cast<std::size_t>(report_.bad_group)]->contacts_;
    const int body = contacts.body(static_cast<std::size_t>(report_.bad_contact));
    error->one(FLERR, "Fix " + std::string(style) + ": contact of atom " + std::to_string(atom->tag[body]) +
                          ": " + report_.reason);
  }
}

void FixIlaw::add_forces(double velocity_step) {
  const double to_force = 1.0 / (velocity_step * force->ftm2v);
  for (FixIlaw* fix : all_) std::fill_n(fix->kept_.begin(), atom->nlocal, Kept{});
  for (std::size_t i = 0; i < static_cast<std::size_t>(atom->nlocal); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      kept_[i][c] = to_force * total_[6 * i + c];
      kept_[i][3 + c] = to_force * total_[6 * i + 3 + c];
      atom->f[i][c] += kept_[i][c];
      atom->torque[i][c] += kept_[i][3 + c];
    }
}

// A contact belongs to the rank of its counterpart, a contact with a wall to that of its body: what it leaves
// goes with this atom when it moves to another rank.
void FixIlaw::store() {
  const int here = atom->nlocal;
  for (FixIlaw* fix : all_) {
    for (int i = 0; i < here; ++i) fix->rows_[static_cast<std::size_t>(i)].clear();
    const auto& contacts = *fix->contacts_;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      const int keeper = contacts.counterpart(k) < 0 ? contacts.body(k) : contacts.counterpart(k);
      contacts.keep(k, fix->rows_[static_cast<std::size_t>(keeper)]);
    }
    fix->maxexchange = fix->most_packed();
  }
}

void FixIlaw::tally() {
  const FixIlaw& leader = *all_.back();
  report_ = leader.report_;
  contacts_closed_ = overlap_ = stored_ = 0.0;
  approach_ = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < contacts_->size(); ++k) {
    overlap_ = std::max(overlap_, -contacts_->gap(k));
    for (std::size_t part = 0; part < 3; ++part) dissipated_[part] += contacts_->energy(k)[part];
    stored_ += contacts_->energy(k)[ILAW_ENERGY_STORED];
    if (contacts_->status(k) == ILAW_FREE) continue;
    contacts_closed_ += 1.0;
    const int counterpart = contacts_->counterpart(k);
    const double* other = counterpart < 0 ? contacts_->wall_velocity(k) : leader.velocity_after(counterpart);
    const double* own = leader.velocity_after(contacts_->body(k));
    double opening = 0.0;
    for (std::size_t c = 0; c < 3; ++c) opening += contacts_->normal(k)[c] * (own[c] - other[c]);
    approach_ = std::max(approach_, -opening);
  }
}

double FixIlaw::compute_vector(int i) {
  const std::array<double, OUTPUTS> here{
      contacts_closed_, 0.0,    0.0, overlap_, approach_, dissipated_[0], dissipated_[1],
      dissipated_[2],   stored_};
  if (i == SWEEPS) return report_.sweeps;
  if (i == RESIDUAL) return report_.residual;
  double all = here[static_cast<std::size_t>(i)];
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_DOUBLE, i == OVERLAP || i == APPROACH ? MPI_MAX : MPI_SUM, world);
  return i == APPROACH && !std::isfinite(all) ? 0.0 : all;
}

void FixIlaw::forward(double* values, int width) {
  sent_ = values;
  width_ = width;
  comm->forward_comm_fix(this, width);
}

int FixIlaw::pack_forward_comm(int n, int* list, double* buffer, int, int*) {
  for (int i = 0; i < n; ++i)
    std::copy_n(sent_ + static_cast<std::ptrdiff_t>(list[i]) * width_, width_, buffer + i * width_);
  return n * width_;
}

void FixIlaw::unpack_forward_comm(int n, int first, double* buffer) {
  std::copy_n(buffer, n * width_, sent_ + static_cast<std::ptrdiff_t>(first) * width_);
}

void FixIlaw::reverse(double* values, int width) {
  sent_ = values;
  width_ = width;
  comm->reverse_comm_fix(this, width);
}

int FixIlaw::pack_reverse_comm(int n, int first, double* buffer) {
  std::copy_n(sent_ + static_cast<std::ptrdiff_t>(first) * width_, n * width_, buffer);
  return n * width_;
}

void FixIlaw::unpack_reverse_comm(int n, int* list, double* buffer) {
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < width_; ++c)
      sent_[static_cast<std::ptrdiff_t>(list[i]) * width_ + c] += buffer[i * width_ + c];
}

}  // namespace LAMMPS_NS

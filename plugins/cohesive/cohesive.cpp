// Cohesive zones: a bond that softens, with contact, friction and bounded damage rate. See cohesive.md.
#include "softening.hpp"

#include "../bond/bond.hpp"

#include <ilaw/kit/law.hpp>
#include <ilaw/kit/plugin.hpp>

namespace {

using namespace bond_law;
using namespace cohesive_law;

constexpr const char* shape_choices[] = {"bilinear", "exponential", "camacho_ortiz"};
constexpr const char* friction_weight_choices[] = {"damage", "stiffness"};
constexpr double exponential = 1.0, camacho_ortiz = 2.0, by_stiffness = 1.0;

// kappa of a rigid bond that is to break: it leaves 2^-100 of the free motion.
constexpr double most_rigid = 0x1p100;

// The scale of damage is at least this part of what shear is soft by, which leaves 43 bits to its traction.
constexpr double softest_shear = 0x1p-10;

template <class V>
struct cohesive : adhesive_bond<cohesive, V> {
  double shape;
  V strength;
  V toughness;
  V strength_2;
  V toughness_2;
  V mixing_exponent;
  V stiffness;
  V friction;
  double friction_weight;
  V delay_time;
  V delay_exponent;
  V heat_partition;
  V wear_coefficient;

  static constexpr law_card card{
      .id = "cohesive",
      .title = "Cohesive zone with contact, friction and delayed damage",
      .doc =
          "Bond that holds up to its strength, then softens until its toughness is spent; unloads to the "
          "origin; contact and friction take over as it breaks. Solved with any H for any initial stiffness, "
          "also infinite, which does not shorten the stable time increment.",
      .inputs = reads_gap | reads_v_previous | reads_area,
      .capabilities = can_adhere | can_store_energy,
      .permissions = may_skip_free,
      .gives_rupture = true};

  static constexpr const char* references[] = {
      "G. T. Camacho, M. Ortiz, 1996, Computational modelling of impact damage in brittle materials",
      "M. L. Benzeggagh, M. Kenane, 1996, Measurement of mixed-mode delamination fracture toughness",
      "A. Turon, P. P. Camanho, J. Costa, C. G. Davila, 2006, A damage model for the simulation of "
      "delamination in advanced composites under variable-mode loading",
      "G. Alfano, E. Sacco, 2006, Combining interface damage and friction in a cohesive-zone model",
      "O. Allix, J.-F. Deu, 1997, Delayed-damage modelling for fracture prediction of laminated composites "
      "under dynamic loading"};

  static constexpr parameter<cohesive> parameters[] = {
      {.member = &cohesive::shape,
       .name = "shape",
       .doc = "bilinear, exponential: modes mixed by Benzeggagh and Kenane; camacho_ortiz: rigid, then "
              "linear in an effective opening.",
       .choices = shape_choices},
      {.member = &cohesive::strength,
       .name = "strength",
       .symbol = "sigma_1",
       .unit = "N/m^2",
       .doc = "Largest normal traction; inf: never breaks, 0: no bond.",
       .required = true,
       .infinity_allowed = true},
      {.member = &cohesive::toughness,
       .name = "toughness",
       .symbol = "G_1",
       .unit = "J/m^2",
       .doc = "Energy per area that opening takes; 0: no bond.",
       .required = true},
      {.member = &cohesive::strength_2,
       .name = "strength_2",
       .symbol = "sigma_2",
       .unit = "N/m^2",
       .doc = "Largest tangential traction; 0: the same as strength.",
       .infinity_allowed = true},
      {.member = &cohesive::toughness_2,
       .name = "toughness_2",
       .symbol = "G_2",
       .unit = "J/m^2",
       .doc = "Energy per area that shear takes; 0: the same as toughness."},
      {.member = &cohesive::mixing_exponent,
       .name = "mixing_exponent",
       .symbol = "eta",
       .doc = "Exponent of Benzeggagh and Kenane, of toughness and of squared strength.",
       .default_value = 1.0,
       .minimum_excluded = true},
      {.member = &cohesive::stiffness,
       .name = "stiffness",
       .symbol = "K",
       .unit = "N/m^3",
       .doc = "Initial stiffness per area; inf: rigid until the strength is reached.",
       .default_value = infinity,
       .minimum_excluded = true,
       .infinity_allowed = true},
      friction_parameter(&cohesive::friction).with_doc("Coefficient of friction of what is broken."),
      {.member = &cohesive::friction_weight,
       .name = "friction_weight",
       .doc = "Which part of the area is broken: the damage, or the lost part of the stiffness (Alfano and "
              "Sacco 2006).",
       .choices = friction_weight_choices},
      {.member = &cohesive::delay_time,
       .name = "delay_time",
       .symbol = "tau_c",
       .unit = "s",
       .doc = "Time that full damage takes at least; 0: damage follows at once."},
      {.member = &cohesive::delay_exponent,
       .name = "delay_exponent",
       .symbol = "a",
       .doc = "How sharply the damage rate reaches its bound 1/tau_c.",
       .default_value = 1.0,
       .minimum_excluded = true},
      heat_partition_parameter(&cohesive::heat_partition),
      wear_coefficient_parameter(&cohesive::wear_coefficient)};

  static constexpr double broken = 1.0;
  static constexpr auto state_variables = bond_variables("damage", "0: intact, 1: broken.");

  const char* conflict() const {
    if ((strength == infinity) != (shear_strength() == infinity))
      return "parameters 'strength' and 'strength_2' must both be infinite, or both finite";
    if (shape == camacho_ortiz && strength == infinity)
      return "shape \"camacho_ortiz\" weighs shear by the ratio of its strengths: parameter 'strength' must be "
             "finite (a bond that never breaks: \"bilinear\" with 'strength' inf)";
    if (shape == camacho_ortiz && stiffness < infinity)
      return "shape \"camacho_ortiz\" is rigid: parameter 'stiffness' must be inf";
    if (shape == camacho_ortiz && shear_toughness() != toughness)
      return "shape \"camacho_ortiz\" has one toughness: parameter 'toughness_2' must be the same as "
             "'toughness'";
    if (friction_weight == by_stiffness && stiffness == infinity)
      return "friction_weight \"stiffness\" needs a finite 'stiffness': a rigid bond has lost all of it at any "
             "damage";
    if (delay_time > 0.0 && stiffness == infinity)
      return "parameter 'delay_time' > 0 needs a finite 'stiffness': the opening of a rigid bond says "
             "nothing of its load";
    if (stores_more(strength, toughness))
      return "parameter 'toughness' is below 'strength'^2/(2 'stiffness'), the energy that the bond stores "
             "when its strength is reached";
    if (stores_more(shear_strength(), shear_toughness()))
      return "parameter 'toughness_2' is below 'strength_2'^2/(2 'stiffness'), the energy that the bond "
             "stores in shear when its strength is reached (0: the same as 'toughness' and 'strength')";
    if (bonds() && mixes() && softness_scale() == infinity)
      return "parameter 'strength_2' is too small: 'toughness_2'/'strength_2'^2, which damage is measured by, "
             "overflows";
    return nullptr;
  }

  template <class Node>
  void initialise(Node& node) const {
    node.state.memory = bonds() ? 0.0 : 1.0;
  }

  // ---- what is the same at all nodes

  struct common : bond_common<V> {
    V steepest;                    // -T' of all mode mixes
    V flexibility, softness;       // 1/K, b
    softening<V> opened;           // mode I
    mask_of<V> mixes, is_delayed;  // whether modes differ; whether damage takes time
  };
  common prepare(const step_sizes& step) const {
    const V ratio = shape == camacho_ortiz ? shear_strength() / strength : V(1.0);
    const softening<V> opened = softening_at(mode_1());
    const V steep = opened.steepest();
    return {{step, ratio * ratio},
            select(mixes(), larger(steep, softening_at(mode_2()).steepest()), steep),
            flexibility(),
            zero_unless(strength < infinity, softness_scale()),
            opened,
            mixes(),
            mask_of<V>((delay_time > 0.0) & (strength < infinity))};
  }

  // ---- the bond, for the kit (bond.hpp)

  mask_of<V> bonds() const { return (strength > 0.0) & (toughness > 0.0); }
  // d, or 1 - k/K = d (1/K + b)/(1/K + d b).
  V broken_part(V damage, const common& all) const {
    if (friction_weight != by_stiffness) return damage;
    return damage * ((all.flexibility + all.softness) / secant_of(damage, all).soft);
  }
  static V energy(V damage, V size, const common& all) {
    const secant<V> s = secant_of(damage, all);
    return select(s.soft > 0.0, 0.5 * s.stiff / s.soft * size * size, 0.0);
  }

  // A rigid bond that holds is a tie. Its traction is compared with the weight of the work that it does.
  mask_of<V> is_rigid(V damage) const { return (stiffness == infinity) & (damage == 0.0); }
  mask_of<V> surely_bears(vector<V> r, V capacity) const {
    const pull p(r, pull_weight());
    const V most = capacity * smaller(strength, shear_strength());
    return p.is_clear(most) & (p.square <= most * most);
  }
  mask_of<V> bears(vector<V> r, V capacity) const {
    const pull p(r, pull_weight());
    const V along = softening_at(select(mixes(), mix_of(p.normal, p.shear, p.square), mode_1())).strength;
    const V most = capacity * larger(along, smaller(strength, shear_strength()));
    return (p.is_clear(most) & (p.square <= most * most)) | ((!p.is_clear(most)) & (p.size <= most));
  }

  // Elastic where that stays below the softening.
  template <class Step>
  void as_it_was(const Step& step, V damage, const common& all, bond_result<Step>& found) const {
    const secant<V> now = secant_of(damage, all);
    const mask_of<V> is_soft = now.soft > 0.0;
    const V kappa = zero_unless(is_soft, step.compliance * now.stiffness());
    step.move(found.motion, kappa, this->friction_of(damage, all));
    const mask_of<V> stays = (strength == infinity) | is_below(damage, now, found.motion, all);
    found.holds = is_soft & step.has_scale(kappa) & stays;
  }

  // Else the mean traction on the way from w^- to w^+, with the friction of the damage after it: the unknown
  // is the damage, d = D(w(d)), which falls with more friction.
  template <class Step>
  void change(const Step& step, mask_of<V> where, const common& all, bond_result<Step>& found) const {
    const mask_of<V> is_unique = step.compliance * step.trace() * all.steepest <= 1.0;
    if constexpr (!is_scalar) {
      found.left =
          where & !mask_of<V>(is_unique & step.has_scale(most_kappa(step, secant_of(found.memory, all))));
      where = where & !found.left;
      if (!any(where)) return;
    }
    const curve_before before(found.memory, all);
    V coefficient = this->friction_of(before.damage, all);
    bool is_tried = true;
    root_between(before.damage, V(1.0), before.damage, where, [&](V damage) ILAW_KIT_LAMBDA {
      coefficient = select(where, this->mean_friction(before.damage, damage, all), coefficient);
      soften(step, where, all, before, coefficient, is_tried, found);
      is_tried = false;
      const mask_of<V> grows = (found.memory > before.damage) | (damage > before.damage);
      const mask_of<V> rubs = where & grows & found.motion.closed & (friction > 0.0) & (friction < infinity);
      return root_trial<V>{zero_unless(rubs, damage - found.memory), 1.0, 1.0, 1.0, none<V>()};
    });
    if constexpr (is_scalar)
      if (!is_unique && has_another(step, before, coefficient, all))
        found.refused = static_cast<double>(refusal::several_solutions);
  }

 private:
  static constexpr bool is_scalar = std::is_same_v<V, double>;

  // ---- the curve of the page

  static mode_mix<V> mode_1() { return {1.0, 0.0}; }
  static mode_mix<V> mode_2() { return {0.0, 1.0}; }
  mask_of<V> mixes() const {
    if (shape == camacho_ortiz) return none<V>();
    return (shear_strength() != strength) | (shear_toughness() != toughness);
  }
  V flexibility() const { return select(stiffness < infinity, 1.0 / stiffness, V(0.0)); }
  V shear_strength() const { return select(strength_2 > 0.0, strength_2, strength); }
  V shear_toughness() const { return select(toughness_2 > 0.0, toughness_2, toughness); }
  V pull_weight() const { return shape == camacho_ortiz ? shear_strength() / strength : V(1.0); }
  bool stores_more(double peak, double energy) const {
    return peak < infinity && energy > 0.0 && 0.5 * peak * peak * flexibility() > energy;
  }

  // An impulse with the weights of the bond.
  struct pull {
    V normal, shear, square, size;
    pull(vector<V> r, V weight) {
      const V n = positive_part(-r.n), t1 = r.t1 / weight, t2 = r.t2 / weight;
      normal = n * n;
      shear = t1 * t1 + t2 * t2;
      square = normal + shear;
      size = length(n, t1, t2);
    }
    mask_of<V> is_clear(V most) const { return (square < 0x1p900) & (most * most > 0x1p-900); }
  };

  softening<V> softening_at(mode_mix<V> mix) const {
    const mode_mix<V> weights = weights_of(mix);
    const V energy = weights.mean(toughness, shear_toughness()), s1 = strength, s2 = shear_strength();
    const V peak = select(weights.shear > 0.0, square_root(weights.mean(s1 * s1, s2 * s2)), s1);
    const double full = softening<V>::fullness(shape == exponential);
    const V width = positive_part(energy / peak - 0.5 * peak * flexibility()) / full;
    return {peak, peak * flexibility(), width, peak / width, shape == exponential};
  }
  // B^eta and 1 - B^eta.
  mode_mix<V> weights_of(mode_mix<V> mix) const {
    const V b = mix.shear, n = mix.normal, y = mixing_exponent;
    mode_mix<V> weights = mix;
    if (const auto is = y == 1.5; any(is)) {
      const V power = b * square_root(b);
      weights = select(is, {n * (1.0 + b + b * b) / (1.0 + power), power}, weights);
    }
    if (const auto is = y == 2.0; any(is)) weights = select(is, {n * (1.0 + b), b * b}, weights);
    if (const auto is = (y != 1.0) & (y != 1.5) & (y != 2.0); any(is))
      weights = select(is, any_weights_of(mix), weights);
    return weights;
  }
  // The logarithm is that of 1 - n where b is near 1, with what the difference rounds off, as in
  // log_one_plus.
  [[gnu::noinline]] mode_mix<V> any_weights_of(mode_mix<V> mix) const {
    const mask_of<V> is_near = mix.normal < 0.5;
    const V left = select(is_near, 1.0 - mix.normal, mix.shear);
    const V rounded_off = zero_unless(is_near, ((1.0 - left) - mix.normal) / left);
    const exponentials<V> power = exponentials_of(mixing_exponent * (log(left) + rounded_off));
    return {-power.minus_one, power.exp};
  }
  template <class Motion>
  softening<V> curve(const Motion& m, const common& all) const {
    if (!any(all.mixes)) return all.opened;
    const V n = m.opening.n * m.opening.n, shear = all.weight * tangential_product(m.opening, m.opening);
    return softening_at(select(all.mixes, mix_of(n, shear, m.size * m.size), mode_1()));
  }

  // Damage says how soft the bond is; along a bilinear opening it is the part of the toughness that is spent.
  // Close to 1 it has only 53 bits, of which a shear that is much softer would leave none.
  V softness_at(mode_mix<V> mode) const {
    const softening<V> s = softening_at(mode);
    return s.width / s.strength;
  }
  V softness_scale() const {
    const V opened = softness_at(mode_1());
    return select(mixes(), larger(opened, softest_shear * softness_at(mode_2())), opened);
  }
  static secant<V> secant_of(V damage, const common& all) {
    return {1.0 - damage, all.flexibility + damage * all.softness};
  }
  static V damage_of(V opening, V traction, const common& all) {
    return (opening - all.flexibility * traction) / (opening + all.softness * traction);
  }

  // ---- a step

  template <class Step>
  static V most_kappa(const Step& step, secant<V> now) {
    return select(now.soft > 0.0, step.compliance * now.stiffness(), V(most_rigid));
  }

  template <class Motion>
  mask_of<V> is_below(V damage, secant<V> now, const Motion& m, const common& all) const {
    const softening<V> s = curve(m, all);
    const V held = now.stiff * m.size, least = smaller(strength, shear_strength());
    const mask_of<V> surely = (damage == 0.0) & (held <= now.soft * least);
    const mask_of<V> below = (all.mixes & (surely | (held <= now.soft * s.traction(m.size)))) |
                             ((!all.mixes) & (m.size <= s.meets(now)));
    if (!any(all.is_delayed)) return below;
    return (all.is_delayed & (delayed_damage(damage, m.size, s, all) == damage)) |
           ((!all.is_delayed) & below);
  }

  // Values that all trials of a step share.
  struct curve_before {
    V damage;
    secant<V> now;
    V stiffness, met;  // the secant's; where it meets the curve of mode I
    curve_before(V d, const common& all)
        : damage(d), now(secant_of(d, all)), stiffness(now.stiffness()), met(all.opened.meets(now)) {}
  };

  // (1 + kappa) (kappa (y + f) - 2 c T) = 0, y = |w^+|, f = |w^-|, with the mean traction T on the way. Where
  // a bilinear bond opens in one direction this is linear in kappa. y' is known, and dT/dy = (traction -
  // T)/(y - f) along one curve; elsewhere the softening is taken for the slope.
  template <class Motion, class Step>
  ILAW_KIT_INLINE root_trial<V> trial(const Step& step, const Motion& m, const curve_before& b,
                                      const common& all) const {
    const softening<V> s = curve(m, all);
    const V sum = m.size + step.before, c = step.compliance;
    V mean =
        s.mean_traction_on_path(b.stiffness, any(all.mixes) ? s.meets(b.now) : b.met, step.before, m.size);
    if (any(all.is_delayed)) {
      const V after = secant_of(delayed_damage(b.damage, m.size, s, all), all).stiffness();
      mean = select(all.is_delayed, 0.25 * (b.stiffness + after) * sum, mean);
    }
    const mask_of<V> is_simple = (!all.mixes) & (!all.is_delayed) & (shape != exponential);
    const V end = all.opened.onset + all.opened.width;
    const V traction =
        select(m.size < b.met, b.stiffness * m.size, all.steepest * (end - smaller(m.size, end)));
    const V way = m.size - step.before;
    const mask_of<V> moves = is_simple & (absolute(way) > 0x1p-26 * sum);
    const V gain = select(moves, traction - mean, -0.5 * all.steepest),
            run = m.size * select(moves, way, V(1.0));
    const V kappa = m.held.kappa, more = 1.0 + kappa, excess = kappa * sum - 2.0 * c * mean;
    const V slowed = step.gives_way(m) * (kappa * select(moves, way, V(1.0)) - 2.0 * c * gain);
    const mask_of<V> is_exact = is_simple & step.is_smooth(m);
    return {more * excess, more * sum, run * (excess + more * sum) - more * slowed, run, is_exact};
  }

  // The step with this coefficient of friction. The bond as it was is the first trial, but not if that is
  // stiff. is_tried: found is that.
  template <class Step>
  ILAW_KIT_INLINE void soften(const Step& step, mask_of<V> where, const common& all, const curve_before& b,
                              V coefficient, bool is_tried, bond_result<Step>& found) const {
    const V most = most_kappa(step, b.now), first = select(where & (most > 1.0), 0.0, most);
    is_tried = is_tried && !any(where & (first != found.motion.held.kappa));
    root_trial<V> last;
    root_between(V(0.0), most, first, where, [&](V kappa) ILAW_KIT_LAMBDA {
      if (!is_tried) step.move(found.motion, kappa, coefficient);
      is_tried = false;
      return last = trial(step, found.motion, b, all);
    });
    if constexpr (!is_scalar) {
      const V scale = (found.motion.held.kappa + step.compliance * all.steepest) * last.size;
      found.left = found.left | (where & !mask_of<V>(absolute(last.value) <= 0x1p-44 * scale));
    }
    found.memory = select(where, damage_after(found.motion, b.damage, all), b.damage);
  }
  template <class Motion>
  V damage_after(const Motion& m, V damage, const common& all) const {
    const softening<V> s = curve(m, all);
    const V reached = damage_of(m.size, s.traction(m.size), all);
    V after = select(m.size > s.onset, larger(damage, reached), damage);
    if (any(all.is_delayed)) after = select(all.is_delayed, delayed_damage(damage, m.size, s, all), after);
    return after;
  }

  // Exact for the constant target f that the opening at the end of the step sets (Allix and Deu 1997), z = f
  // - d before the step: d grows by -ln(1 - q)/a, q = (1 - exp(-a z)) (1 - exp(-a h/tau_c)). It may be tiny:
  // a stiff bond of great toughness is soft already at a damage of 1e-16. Where q is large, the same is f -
  // ln(1 + (exp(a z) - 1) exp(-a h/tau_c))/a.
  [[gnu::noinline]] V delayed_damage(V damage, V size, const softening<V>& s, const common& all) const {
    const V progress = s.progress(size);
    const mask_of<V> softens = (progress < 1.0) & (progress > 0.0);
    const V target = select(softens, damage_of(size, s.traction(size), all), progress),
            distance = target - damage;
    const mask_of<V> grows = distance > 0.0;
    if (!any(grows)) return damage;
    const V a = delay_exponent, decline = a * all.step.position_step / delay_time;
    const V q = exp_minus_one(zero_unless(grows, -a * distance)) * exp_minus_one(-decline);
    const mask_of<V> is_slow = q < 0.5;
    V next = smaller(damage - log_one_plus(zero_unless(is_slow, -q)) / a, V(1.0));
    if (any(grows & !is_slow)) {
      const V ahead = a * distance - decline;
      const V reached = log((1.0 - exp(-decline)) + exp(smaller(ahead, V(40.0))));
      const V left = select(ahead < 40.0, reached, ahead);
      next = select(is_slow, next, larger(damage, smaller(target - left / a, V(1.0))));
    }
    return select(grows, next, damage);
  }

  // There is one solution where the softening is not steeper than the node gives way, c tr(H W) |T'| <= 1.
  // Beyond, the sign changes of the excess are counted as the node is left ever more of its free motion.
  // Several are a snap-back, and nothing says how much of it this step is to do.
  template <class Step>
  bool has_another(const Step& step, const curve_before& b, double coefficient, const common& all) const {
    const double ratio = step.trace(), most = most_kappa(step, b.now), first = 1.0 / (1.0 + ratio * most);
    typename Step::motion m;
    return changes_sign_again([&](double part) {
      const double left = first + part * (1.0 - first);
      step.move(m, (1.0 - left) / (left * ratio), coefficient);
      return trial(step, m, b, all).value;
    });
  }
};

}  // namespace

ILAW_PLUGIN("cohesive", "1.0.0", "ilaw", "BSD-3-Clause", cohesive)

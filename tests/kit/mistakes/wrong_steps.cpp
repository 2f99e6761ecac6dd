// The same for mistakes within a function of a law, which compilers look at where there is no other. Never built:
// mistakes_test.py has its syntax checked, and reads the answer.
#include <ilaw/kit.hpp>

#include <cmath>

using namespace ilaw::kit;

// The part that all laws have.
#define WRONG(law)                                                                                                   \
  template <class V>                                                                                                 \
  struct law {                                                                                                       \
    V a;                                                                                                             \
    static constexpr law_card card{.id = "wrong",                                                                    \
                                   .title = "A law",                                                                 \
                                   .doc = "A mistake.",                                                              \
                                   .delassus_forms = ILAW_DELASSUS_SCALAR,                                           \
                                   .inputs = 0};                                                                     \
    static constexpr const char* references[] = {"none"};                                                            \
    static constexpr parameter<law> parameters[] = {{.member = &law::a, .name = "a"}};                              \
    template <class Node>                                                                                            \
    status_of<V> step(Node& node) const {
#define END_WRONG \
  }               \
  }

// the law reads gap: write reads_gap among .inputs of its card
WRONG(gap_not_declared)
  node.impulse.n = zero_unless(node.gap <= 0.0, a);
  return status::free;
END_WRONG;

// the law reads area: write reads_area among .inputs of its card
WRONG(area_not_declared)
  node.impulse.n = a * node.area;
  return status::free;
END_WRONG;

// the law reads v_previous: write reads_v_previous among .inputs of its card
WRONG(contact_without_v_previous)
  const contact_condition<V> contact = contact_leaving_at<V>(0.0, a, node.v_free.n, node.v_previous.n);
  node.impulse.n = -contact.excess;
  return status::free;
END_WRONG;

// passing 'const ilaw::kit::pack_of<1>' as 'this' argument discards qualifiers [-fpermissive]
WRONG(writes_v_free)
  node.v_free.n = 0.0;
  return status::free;
END_WRONG;

// no matching function for call to 'exp(const ilaw::kit::pack_of<1>&)'
WRONG(exp_of_libm)
  node.impulse.n = std::exp(a);
  return status::free;
END_WRONG;

// use of deleted function 'void ilaw::kit::operator&&(pack_mask<Registers>, Other) [with Other = pack_mask<1>; int Registers = 1]'
WRONG(and_of_masks)
  node.impulse.n = zero_unless(a > 0.0 && a < 1.0, a);
  return status::free;
END_WRONG;

// use of deleted function 'void ilaw::kit::operator||(pack_mask<Registers>, Other) [with Other = pack_mask<1>; int Registers = 1]'
WRONG(or_of_masks)
  node.impulse.n = zero_unless(a > 0.0 || a < 1.0, a);
  return status::free;
END_WRONG;

// use of deleted function 'ilaw::kit::pack_mask<Registers>::operator bool() const [with int Registers = 1]'
WRONG(branch_on_a_mask)
  if (a > 0.0) node.impulse.n = a;
  return status::free;
END_WRONG;

// could not convert '3.0e+0' from 'double' to 'ilaw::kit::status_of<ilaw::kit::pack_of<1> >'
WRONG(status_by_number)
  node.impulse.n = a;
  return 3.0;
END_WRONG;

// no matching function for call to 'ilaw::kit::status_of<ilaw::kit::pack_of<1> >::status_of()'
WRONG(status_that_may_stay_unset)
  status_of<V> found;
  if (node.wants_energy) found = status::closed;
  return found;
END_WRONG;

// The compiler looks at each.
#define SEEN(law) auto* const seen_##law = &detail::library_of<law>::describe
SEEN(gap_not_declared);
SEEN(area_not_declared);
SEEN(contact_without_v_previous);
SEEN(writes_v_free);
SEEN(exp_of_libm);
SEEN(and_of_masks);
SEEN(or_of_masks);
SEEN(branch_on_a_mask);
SEEN(status_by_number);
SEEN(status_that_may_stay_unset);

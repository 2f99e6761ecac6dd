// SPDX-License-Identifier: BSD-3-Clause
#include "check/field.hpp"

#include "check/trial.hpp"

#include <algorithm>

namespace ilaw::check {

Field::Field(Memory& memory, const char* name, std::size_t components, std::size_t room, Order order, Use use,
             ilaw_number_type numbers, std::size_t spread)
    : name_(name), components_(components), is_backward_(order == Order::backward) {
  node_stride_ = order == Order::by_component ? 1
                 : order == Order::spread     ? 2 * components + 1 + spread
                                              : components;
  component_stride_ = order == Order::by_component ? room + 3 : order == Order::spread ? 2 : 1;
  size_ = components == 0 ? 0 : (room - 1) * node_stride_ + (components - 1) * component_stride_ + 1;
  if (numbers == ILAW_NUMBERS_FLOAT)
    floats_ = static_cast<float*>(memory.take(name, size_ * sizeof(float), use));
  else
    values_ = static_cast<double*>(memory.take(name, size_ * sizeof(double), use));
  clear();
}

void Field::put(std::size_t node, std::size_t component, double value) {
  if (floats_)
    floats_[place(node, component)] = static_cast<float>(value);
  else
    values_[place(node, component)] = value;
}
template <class Array>
Array Field::array() const {
  const std::size_t first = size_ > 0 ? place(0, 0) : 0;
  return {values_ ? values_ + first : nullptr, floats_ ? floats_ + first : nullptr, stride(node_stride_),
          stride(component_stride_)};
}
ilaw_input Field::input() const { return array<ilaw_input>(); }
ilaw_output Field::output() const { return array<ilaw_output>(); }
void Field::clear() {
  if (floats_)
    std::fill_n(floats_, size_, static_cast<float>(sentinel));
  else
    std::fill_n(values_, size_, sentinel);
}

bool Field::is_untouched_beside(const std::vector<std::size_t>& nodes) {
  std::vector<bool> used(size_);
  for (const std::size_t node : nodes)
    for (std::size_t c = 0; c < components_; ++c) used[place(node, c)] = true;
  for (std::size_t k = 0; k < size_; ++k)
    if (!used[k] && !same_bits(number(k), sentinel)) return false;
  return true;
}

}  // namespace ilaw::check

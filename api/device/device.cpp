// The functions of device.h: no exception out.
// SPDX-License-Identifier: BSD-3-Clause
#include "driver.hpp"
#include "totals.hpp"

#include <ilaw/sized.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <new>

extern "C" {
#define ILAW_OWN_IMAGE(name) [[gnu::visibility("hidden")]] extern const char name[], name##_end[]
#if defined(ILAW_HAS_PTX)
ILAW_OWN_IMAGE(ilaw_device_ptx);
#endif
#if defined(ILAW_HAS_SPIRV)
ILAW_OWN_IMAGE(ilaw_device_spirv);
#endif
}

struct ilaw_device {
  std::unique_ptr<ilaw::device::Driver> driver;
  std::string name;
};

namespace ilaw::device {
namespace {

// Memory of a device.
template <class T>
class Array {
 public:
  Array(Driver& driver, std::int64_t count) : driver_(driver) {
    size_ = static_cast<std::size_t>(std::max<std::int64_t>(count, 1)) * sizeof(T);
    memory_ = static_cast<T*>(driver_.allocate(size_));
    if (!memory_) throw Error(ILAW_OUT_OF_MEMORY, "the device is out of memory");
  }
  ~Array() { driver_.free(memory_); }
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;

  T* get() const { return memory_; }
  std::vector<T> read(void* queue, std::int64_t count) const {
    std::vector<T> values(static_cast<std::size_t>(count));
    driver_.read(queue, values.data(), memory_, values.size() * sizeof(T));
    return values;
  }

 private:
  Driver& driver_;
  std::size_t size_;
  T* memory_;
};

const ilaw_device_law& extension_of(const ilaw_law& law) {
  const void* const found = law.extension ? law.extension(ILAW_DEVICE) : nullptr;
  if (!found)
    throw Error(ILAW_UNSUPPORTED,
                std::string("law '") + law.id + "' has no kernels: its library was built without");
  return *static_cast<const ilaw_device_law*>(found);
}

ilaw_instance_info info_of(const ilaw_law& law, const ilaw_instance& instance) {
  ilaw_instance_info info{};
  info.struct_size = sizeof info;
  if (const ilaw_result code = law.info(&instance, &info); code != ILAW_OK)
    throw Error(code, std::string("law '") + law.id + "' does not describe its instance");
  return info;
}

const ilaw_device_image& image_of(const ilaw_device_law& law, ilaw_kind kind) {
  for (std::uint32_t k = 0; k < law.image_count; ++k)
    if (law.images[k]->kind == kind) return *law.images[k];
  throw Error(ILAW_UNSUPPORTED,
              kind == ILAW_IMAGE_PTX ? "the library has no PTX" : "the library has no SPIR-V");
}

// The image with the kernels of totals.cpp.
ilaw_device_image own_image(ilaw_kind kind) {
  ilaw_device_image image{sizeof(ilaw_device_image), kind, nullptr, nullptr};
#if defined(ILAW_HAS_PTX)
  if (kind == ILAW_IMAGE_PTX) image.begin = ilaw_device_ptx, image.end = ilaw_device_ptx_end;
#endif
#if defined(ILAW_HAS_SPIRV)
  if (kind == ILAW_IMAGE_SPIRV) image.begin = ilaw_device_spirv, image.end = ilaw_device_spirv_end;
#endif
  if (!image.begin) throw Error(ILAW_UNSUPPORTED, "libilaw_device was built without kernels for this driver");
  return image;
}

double sum_in_tree(const std::vector<double>& parts, int component, std::size_t first, std::size_t count) {
  if (count == 1) return parts[first * sum_components + static_cast<std::size_t>(component)];
  const std::size_t half = count / 2;
  return sum_in_tree(parts, component, first, half) +
         sum_in_tree(parts, component, first + half, count - half);
}

}  // namespace

// Kernels and memory for the batches of one instance.
class Launcher {
 public:
  Launcher(Driver& driver, const ilaw_law& law, const ilaw_instance& instance, std::int64_t most_nodes)
      : driver_(driver),
        law_(extension_of(law)),
        instance_(instance),
        info_(info_of(law, instance)),
        most_nodes_(most_nodes),
        argument_(law_.argument_size),
        reasons_(driver, most_nodes),
        stable_steps_(driver, most_nodes),
        findings_(driver, finding_lanes),
        sums_(driver, sum_lanes * sum_components),
        last_sums_(driver, last_sum_lanes * sum_components) {
    const char* reason = nullptr;
    const char* const name = law_.kernel(&instance, &reason);
    if (!name)
      throw Error(ILAW_UNSUPPORTED, std::string("law '") + law.id + "': " + (reason ? reason : "no kernel"));
    kernel_ = driver.load(image_of(law_, driver.image_kind()), name);
  }

  ilaw_result evaluate(void* queue, const ilaw_batch* batch, bool wants_report, ilaw_report* report) {
    const ilaw_device_findings asked{sizeof(ilaw_device_findings), 0, reasons_.get(), stable_steps_.get()};
    const ilaw_result code =
        law_.argument(&instance_, batch, wants_report ? &asked : nullptr, argument_.data(), report);
    if (code != ILAW_OK) return code;
    batch_ = sized::read(batch);
    if (batch_.node_count > most_nodes_)
      throw Error(ILAW_INVALID_ARGUMENT, "the batch has more nodes than the launcher was made for");
    has_report_ = wants_report;
    if (batch_.node_count == 0) return ILAW_OK;
    std::vector<void*> pointers = pointers_of(batch_);
    if (wants_report) pointers.insert(pointers.end(), {reasons_.get(), stable_steps_.get()});
    kernel_->launch(queue_or_own(queue), batch_.node_count, argument_.data(), argument_.size(), pointers);
    if (wants_report) {
      FindingArgument totals{batch_.node_count, reasons_.get(), stable_steps_.get(), findings_.get()};
      own_kernel(finder_, "ilaw_total_findings")
          .launch(queue_or_own(queue), finding_lanes, &totals, sizeof totals,
                  {reasons_.get(), stable_steps_.get(), findings_.get()});
    }
    return ILAW_OK;
  }

  ilaw_result report(void* queue, ilaw_report* report) {
    if (!has_report_) throw Error(ILAW_INVALID_ARGUMENT, "the last evaluate wanted no report");
    ilaw_device_totals totals{};
    totals.struct_size = sizeof totals;
    totals.first_bad_node = -1;
    totals.stable_step = std::numeric_limits<double>::infinity();
    if (batch_.node_count > 0) join(findings_.read(queue_or_own(queue), finding_lanes), totals);
    if (totals.bad_count > 0) {
      std::uint8_t reason = 0;
      driver_.read(queue_or_own(queue), &reason, reasons_.get() + totals.first_bad_node, 1);
      totals.reason = reason;
      totals.first_bad_node = node_at(queue, totals.first_bad_node);
    }
    return law_.report(&instance_, &totals, report);
  }

  void energy(void* queue, double* sums) {
    const ilaw_output& energy = batch_.energy;
    std::fill_n(sums, sum_components, 0.0);
    if (!energy.values && !energy.floats) throw Error(ILAW_INVALID_ARGUMENT, "the last batch has no energy");
    if (batch_.node_count == 0) return;
    sum({batch_.node_count, sum_lanes, batch_.index, batch_.index64, batch_.index_base, energy.values,
         energy.floats, energy.node_stride, energy.component_stride, sums_.get()},
        queue);
    sum({sum_lanes, last_sum_lanes, nullptr, nullptr, 0, sums_.get(), nullptr, sum_components, 1,
         last_sums_.get()},
        queue);
    const std::vector<double> parts = last_sums_.read(queue_or_own(queue), last_sum_lanes * sum_components);
    for (int c = 0; c < sum_components; ++c) sums[c] = sum_in_tree(parts, c, 0, last_sum_lanes);
  }

 private:
  void* queue_or_own(void* queue) const { return queue ? queue : driver_.own_queue(); }
  Kernel& own_kernel(std::unique_ptr<Kernel>& kernel, const char* name) {
    if (!kernel) kernel = driver_.load(own_image(driver_.image_kind()), name);
    return *kernel;
  }
  void sum(SumArgument argument, void* queue) {
    std::vector<void*> pointers{argument.parts};
    for (const void* p : std::initializer_list<const void*>{argument.index, argument.index64, argument.values,
                                                            argument.floats})
      if (p) pointers.push_back(const_cast<void*>(p));
    own_kernel(summer_, "ilaw_total_sums")
        .launch(queue_or_own(queue), argument.lanes, &argument, sizeof argument, pointers);
  }

  static void join(const std::vector<FindingParts>& parts, ilaw_device_totals& totals) {
    for (const FindingParts& part : parts) {
      totals.bad_count += part.bad_count;
      if (part.first_bad >= 0 && (totals.first_bad_node < 0 || part.first_bad < totals.first_bad_node))
        totals.first_bad_node = part.first_bad;
      totals.stable_step = std::min(totals.stable_step, part.stable_step);
    }
  }
  std::int64_t node_at(void* queue, std::int64_t position) const {
    if (batch_.index64) {
      std::int64_t node = 0;
      driver_.read(queue_or_own(queue), &node, batch_.index64 + position, sizeof node);
      return node - batch_.index_base;
    }
    if (!batch_.index) return position;
    std::int32_t node = 0;
    driver_.read(queue_or_own(queue), &node, batch_.index + position, sizeof node);
    return std::int64_t{node} - batch_.index_base;
  }

  // All arrays of the device in a batch.
  std::vector<void*> pointers_of(const ilaw_batch& b) const {
    std::vector<void*> found;
    const auto add = [&](const void* p) {
      if (p) found.push_back(const_cast<void*>(p));
    };
    const auto add_array = [&](const auto& a) {
      add(a.values);
      add(a.floats);
    };
    add(b.index);
    add(b.index64);
    add(b.status);
    for (const ilaw_input* a : {&b.v_free, &b.delassus, &b.gap, &b.gap_offset, &b.v_previous, &b.area,
                                &b.normal, &b.tangent, &b.state_in})
      add_array(*a);
    for (const ilaw_output* a : {&b.state_out, &b.impulse, &b.velocity, &b.energy}) add_array(*a);
    for (std::uint32_t k = 0; k < info_.per_node_parameter_count; ++k) add_array(b.per_node_parameters[k]);
    for (std::uint32_t k = 0; b.amounts && k < info_.amount_count; ++k) add_array(b.amounts[k]);
    return found;
  }

  Driver& driver_;
  const ilaw_device_law& law_;
  const ilaw_instance& instance_;
  const ilaw_instance_info info_;
  const std::int64_t most_nodes_;
  std::vector<unsigned char> argument_;
  Array<std::uint8_t> reasons_;
  Array<double> stable_steps_;
  Array<FindingParts> findings_;
  Array<double> sums_, last_sums_;
  std::unique_ptr<Kernel> kernel_, finder_, summer_;
  ilaw_batch batch_{};
  bool has_report_ = false;
};

}  // namespace ilaw::device

struct ilaw_launcher {
  ilaw::device::Launcher launcher;
};

namespace {

void put_message(char* message, std::size_t size, const char* text) {
  if (message && size > 0) std::snprintf(message, size, "%s", text);
}
// No exception leaves it: work gives the code, or an exception does, whose text say is told.
template <class Work, class Say>
ilaw_result guarded(Work work, Say say) {
  try {
    return work();
  } catch (const ilaw::device::Error& error) {
    say(error.what());
    return error.code();
  } catch (const std::bad_alloc&) {
    say("out of memory");
    return ILAW_OUT_OF_MEMORY;
  } catch (const std::exception& error) {
    say(error.what());
    return ILAW_INVALID_ARGUMENT;
  }
}
void say_nothing(const char*) {}

ilaw_result open(ilaw_kind driver, std::int32_t number, void* context, void* device_id, ilaw_device** device,
                 char* message, std::size_t message_size) {
  if (!device) return ILAW_INVALID_ARGUMENT;
  *device = nullptr;
  return guarded(
      [&]() -> ilaw_result {
        auto made = std::make_unique<ilaw_device>();
        if (driver == ILAW_DRIVER_CUDA)
          made->driver = ilaw::device::open_cuda(number, context);
        else if (driver == ILAW_DRIVER_OPENCL)
          made->driver = ilaw::device::open_opencl(number, context, device_id);
        else
          throw ilaw::device::Error(ILAW_UNSUPPORTED, "the driver is none of ILAW_DRIVER_*");
        made->name = made->driver->name();
        *device = made.release();
        return ILAW_OK;
      },
      [&](const char* text) { put_message(message, message_size, text); });
}

}  // namespace

ilaw_result ILAW_CALL ilaw_device_open(ilaw_kind driver, int32_t number, ilaw_device** device, char* message,
                                       size_t message_size) {
  return open(driver, number, nullptr, nullptr, device, message, message_size);
}
ilaw_result ILAW_CALL ilaw_device_open_in(ilaw_kind driver, void* context, void* device_id,
                                          ilaw_device** device, char* message, size_t message_size) {
  if (context) return open(driver, 0, context, device_id, device, message, message_size);
  put_message(message, message_size, "the context is null");
  return ILAW_INVALID_ARGUMENT;
}
void ILAW_CALL ilaw_device_close(ilaw_device* device) { delete device; }
const char* ILAW_CALL ilaw_device_name(const ilaw_device* device) { return device->name.c_str(); }
void* ILAW_CALL ilaw_device_queue(const ilaw_device* device) { return device->driver->own_queue(); }

void* ILAW_CALL ilaw_device_allocate(ilaw_device* device, size_t size) {
  void* memory = nullptr;
  guarded(
      [&] {
        memory = device->driver->allocate(size);
        return ilaw_result{ILAW_OK};
      },
      say_nothing);
  return memory;
}
void ILAW_CALL ilaw_device_free(ilaw_device* device, void* memory) {
  if (memory) device->driver->free(memory);
}
ilaw_result ILAW_CALL ilaw_device_write(ilaw_device* device, void* queue, void* to, const void* from,
                                        size_t size) {
  return guarded(
      [&] {
        device->driver->write(queue ? queue : device->driver->own_queue(), to, from, size);
        return ilaw_result{ILAW_OK};
      },
      say_nothing);
}
ilaw_result ILAW_CALL ilaw_device_read(ilaw_device* device, void* queue, void* to, const void* from,
                                       size_t size) {
  return guarded(
      [&] {
        device->driver->read(queue ? queue : device->driver->own_queue(), to, from, size);
        return ilaw_result{ILAW_OK};
      },
      say_nothing);
}

ilaw_result ILAW_CALL ilaw_launcher_create(ilaw_device* device, const ilaw_law* law,
                                           const ilaw_instance* instance, int64_t most_nodes,
                                           ilaw_launcher** launcher, char* message, size_t message_size) {
  if (!launcher) return ILAW_INVALID_ARGUMENT;
  *launcher = nullptr;
  if (!device || !law || !instance || most_nodes < 0) {
    put_message(message, message_size, "device, law or instance is null, or most_nodes is negative");
    return ILAW_INVALID_ARGUMENT;
  }
  return guarded(
      [&] {
        *launcher = new ilaw_launcher{{*device->driver, *law, *instance, most_nodes}};
        return ilaw_result{ILAW_OK};
      },
      [&](const char* text) { put_message(message, message_size, text); });
}
void ILAW_CALL ilaw_launcher_destroy(ilaw_launcher* launcher) { delete launcher; }

ilaw_result ILAW_CALL ilaw_launcher_evaluate(ilaw_launcher* launcher, void* queue, const ilaw_batch* batch,
                                             int32_t wants_report, ilaw_report* report) {
  return guarded([&] { return launcher->launcher.evaluate(queue, batch, wants_report != 0, report); },
                 say_nothing);
}
ilaw_result ILAW_CALL ilaw_launcher_report(ilaw_launcher* launcher, void* queue, ilaw_report* report) {
  return guarded([&] { return launcher->launcher.report(queue, report); }, say_nothing);
}
ilaw_result ILAW_CALL ilaw_launcher_energy(ilaw_launcher* launcher, void* queue,
                                           double sums[ILAW_ENERGY_COUNT]) {
  return guarded(
      [&] {
        launcher->launcher.energy(queue, sums);
        return ilaw_result{ILAW_OK};
      },
      say_nothing);
}

// OpenCL with shared virtual memory, of which the few types and functions that are used are declared here.
// SPDX-License-Identifier: BSD-3-Clause
#include "driver.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ilaw::device {
namespace {

using Result = std::int32_t;
using Handle = void*;
using Bits = std::uint64_t;

constexpr std::uint32_t info_name = 0x102B, info_extensions = 0x1030, info_il_version = 0x105B,
                        info_svm = 0x1053, build_log = 0x1183, svm_pointers = 0x11B6;
constexpr Bits all_devices = 0xFFFFFFFF, read_write = 1;
constexpr std::uint32_t yes = 1;
constexpr std::size_t group_threads = 64;

struct Functions {
  explicit Functions(const SharedLibrary& library) {
    library.find(platforms, "clGetPlatformIDs");
    library.find(devices, "clGetDeviceIDs");
    library.find(device_info, "clGetDeviceInfo");
    library.find(create_context, "clCreateContext");
    library.find(release_context, "clReleaseContext");
    library.find(create_queue, "clCreateCommandQueueWithProperties");
    library.find(release_queue, "clReleaseCommandQueue");
    library.find(with_il, "clCreateProgramWithIL");
    library.find(with_binary, "clCreateProgramWithBinary");
    library.find(build, "clBuildProgram");
    library.find(build_info, "clGetProgramBuildInfo");
    library.find(release_program, "clReleaseProgram");
    library.find(create_kernel, "clCreateKernel");
    library.find(release_kernel, "clReleaseKernel");
    library.find(set_argument, "clSetKernelArg");
    library.find(set_info, "clSetKernelExecInfo");
    library.find(launch, "clEnqueueNDRangeKernel");
    library.find(allocate, "clSVMAlloc");
    library.find(free, "clSVMFree");
    library.find(copy, "clEnqueueSVMMemcpy");
  }

  Result (*platforms)(std::uint32_t, Handle*, std::uint32_t*);
  Result (*devices)(Handle, Bits, std::uint32_t, Handle*, std::uint32_t*);
  Result (*device_info)(Handle, std::uint32_t, std::size_t, void*, std::size_t*);
  Handle (*create_context)(const std::intptr_t*, std::uint32_t, const Handle*, void*, void*, Result*);
  Result (*release_context)(Handle);
  Handle (*create_queue)(Handle, Handle, const Bits*, Result*);
  Result (*release_queue)(Handle);
  Handle (*with_il)(Handle, const void*, std::size_t, Result*);
  Handle (*with_binary)(Handle, std::uint32_t, const Handle*, const std::size_t*, const unsigned char**,
                        Result*, Result*);
  Result (*build)(Handle, std::uint32_t, const Handle*, const char*, void*, void*);
  Result (*build_info)(Handle, Handle, std::uint32_t, std::size_t, void*, std::size_t*);
  Result (*release_program)(Handle);
  Handle (*create_kernel)(Handle, const char*, Result*);
  Result (*release_kernel)(Handle);
  Result (*set_argument)(Handle, std::uint32_t, std::size_t, const void*);
  Result (*set_info)(Handle, std::uint32_t, std::size_t, const void*);
  Result (*launch)(Handle, Handle, std::uint32_t, const std::size_t*, const std::size_t*, const std::size_t*,
                   std::uint32_t, const Handle*, Handle*);
  void* (*allocate)(Handle, Bits, std::size_t, std::uint32_t);
  void (*free)(Handle, void*);
  Result (*copy)(Handle, std::uint32_t, void*, const void*, std::size_t, std::uint32_t, const Handle*,
                 Handle*);
};

void check(Result result, const std::string& what) {
  constexpr Result no_memory[] = {-4, -5, -6};
  if (result == 0) return;
  const bool is_memory = std::find(std::begin(no_memory), std::end(no_memory), result) != std::end(no_memory);
  throw Error(is_memory ? ILAW_OUT_OF_MEMORY : ILAW_UNSUPPORTED,
              "OpenCL: " + what + ": error " + std::to_string(result));
}

struct Place {
  const Functions& opencl;
  Handle context, device;

  std::string text(std::uint32_t which) const {
    std::size_t size = 0;
    if (opencl.device_info(device, which, 0, nullptr, &size) != 0) return "";
    std::string found(size, '\0');
    opencl.device_info(device, which, size, found.data(), nullptr);
    return found.c_str();
  }
};

// SPIR made from SPIR-V by a program like llvm-spirv.
std::string spir_of(const ilaw_device_image& image, const std::string& translator) {
  namespace fs = std::filesystem;
  std::string folder = fs::temp_directory_path() / "ilaw_device_XXXXXX";
  if (!mkdtemp(folder.data())) throw Error(ILAW_UNSUPPORTED, "no temporary folder for " + translator);
  const fs::path from = fs::path(folder) / "image.spv", to = fs::path(folder) / "image.bc";
  std::ofstream(from, std::ios::binary).write(image.begin, image.end - image.begin);
  const char* const command[] = {translator.c_str(), "-r",   "--spirv-target-env=CL1.2", from.c_str(), "-o",
                                 to.c_str(),         nullptr};
  pid_t child = 0;
  int status = posix_spawnp(&child, command[0], nullptr, nullptr, const_cast<char* const*>(command), environ);
  if (status == 0) waitpid(child, &status, 0);
  std::ifstream file(to, std::ios::binary);
  std::string spir{std::istreambuf_iterator<char>(file), {}};
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  if (status != 0 || spir.empty())
    throw Error(ILAW_UNSUPPORTED, translator + " cannot translate the law's SPIR-V");
  return spir;
}

class OpenclProgram {
 public:
  OpenclProgram(const Place& place, const ilaw_device_image& image) : cl_(place.opencl) {
    if (place.text(info_il_version).empty())
      make_of_spir(place, image);
    else
      make_of_spirv(place, image);
  }
  ~OpenclProgram() { cl_.release_program(program_); }
  OpenclProgram(const OpenclProgram&) = delete;
  OpenclProgram& operator=(const OpenclProgram&) = delete;

  Handle kernel(const std::string& name) const {
    Result result = 0;
    const Handle made = cl_.create_kernel(program_, name.c_str(), &result);
    check(result, "no kernel " + name);
    return made;
  }

 private:
  void make_of_spirv(const Place& place, const ilaw_device_image& image) {
    Result result = 0;
    program_ =
        cl_.with_il(place.context, image.begin, static_cast<std::size_t>(image.end - image.begin), &result);
    check(result, "the driver refuses the law's SPIR-V");
    build(place, "");
  }
  void make_of_spir(const Place& place, const ilaw_device_image& image) {
    const char* const translator = std::getenv("ILAW_SPIRV_TRANSLATOR");
    if (!translator || place.text(info_extensions).find("cl_khr_spir") == std::string::npos)
      throw Error(ILAW_UNSUPPORTED, "OpenCL: the device " + place.text(info_name) + " takes no SPIR-V");
    const std::string spir = spir_of(image, translator);
    const std::size_t size = spir.size();
    const auto* bytes = reinterpret_cast<const unsigned char*>(spir.data());
    Result result = 0, of_binary = 0;
    program_ = cl_.with_binary(place.context, 1, &place.device, &size, &bytes, &of_binary, &result);
    check(result, "the driver refuses the law's SPIR");
    build(place, "-x spir -spir-std=1.2");
  }
  void build(const Place& place, const char* options) {
    const Result result = cl_.build(program_, 1, &place.device, options, nullptr, nullptr);
    if (result == 0) return;
    char log[1024] = "";
    cl_.build_info(program_, place.device, build_log, sizeof log - 1, log, nullptr);
    cl_.release_program(program_);
    check(result, "the driver cannot build the law's kernels: " + std::string(log));
  }

  const Functions& cl_;
  Handle program_ = nullptr;
};

class OpenclKernel : public Kernel {
 public:
  OpenclKernel(const Functions& opencl, std::shared_ptr<OpenclProgram> program, const std::string& name)
      : cl_(opencl), program_(std::move(program)), kernel_(program_->kernel(name)) {}
  ~OpenclKernel() override { cl_.release_kernel(kernel_); }
  OpenclKernel(const OpenclKernel&) = delete;
  OpenclKernel& operator=(const OpenclKernel&) = delete;

  void launch(void* queue, std::int64_t threads, void* argument, std::size_t size,
              const std::vector<void*>& pointers) override {
    check(cl_.set_argument(kernel_, 0, size, argument), "the kernel's argument");
    if (!pointers.empty())
      check(cl_.set_info(kernel_, svm_pointers, pointers.size() * sizeof(void*), pointers.data()),
            "the arrays of the batch");
    const std::size_t local = group_threads,
                      global = (static_cast<std::size_t>(threads) + local - 1) / local * local;
    check(cl_.launch(queue, kernel_, 1, nullptr, &global, &local, 0, nullptr, nullptr),
          "the kernel cannot be launched");
  }

 private:
  const Functions& cl_;
  std::shared_ptr<OpenclProgram> program_;
  Handle kernel_;
};

class Opencl : public Driver {
 public:
  Opencl(int number, Handle context, Handle device)
      : library_("libOpenCL.so.1"), cl_(library_), place_{cl_, context, device} {
    if (!place_.device) place_.device = device_number(number);
    Bits shared = 0;
    cl_.device_info(place_.device, info_svm, sizeof shared, &shared, nullptr);
    if (shared == 0)
      throw Error(ILAW_UNSUPPORTED, "OpenCL: the device " + name() + " has no shared virtual memory");
    Result result = 0;
    if (!context) {
      place_.context = cl_.create_context(nullptr, 1, &place_.device, nullptr, nullptr, &result);
      check(result, "no context");
      owns_context_ = true;
    }
    queue_ = cl_.create_queue(place_.context, place_.device, nullptr, &result);
    if (result != 0) {
      if (owns_context_) cl_.release_context(place_.context);
      check(result, "no queue");
    }
  }
  ~Opencl() override {
    cl_.release_queue(queue_);
    if (owns_context_) cl_.release_context(place_.context);
  }
  Opencl(const Opencl&) = delete;
  Opencl& operator=(const Opencl&) = delete;

  std::string name() const override { return place_.text(info_name); }
  void* own_queue() const override { return queue_; }
  ilaw_kind image_kind() const override { return ILAW_IMAGE_SPIRV; }
  void* allocate(std::size_t size) override { return cl_.allocate(place_.context, read_write, size, 0); }
  void free(void* memory) noexcept override { cl_.free(place_.context, memory); }
  void write(void* queue, void* to, const void* from, std::size_t size) override {
    check(cl_.copy(queue, yes, to, from, size, 0, nullptr, nullptr), "write");
  }
  void read(void* queue, void* to, const void* from, std::size_t size) override {
    check(cl_.copy(queue, yes, to, from, size, 0, nullptr, nullptr), "read");
  }
  std::unique_ptr<Kernel> load(const ilaw_device_image& image, const std::string& kernel) override {
    auto program = images_.get(image, [&] { return std::make_shared<OpenclProgram>(place_, image); });
    return std::make_unique<OpenclKernel>(cl_, std::move(program), kernel);
  }

 private:
  // Over all platforms.
  Handle device_number(int number) const {
    std::uint32_t platform_count = 0;
    cl_.platforms(0, nullptr, &platform_count);
    std::vector<Handle> platforms(platform_count), all;
    if (platform_count > 0) cl_.platforms(platform_count, platforms.data(), nullptr);
    for (const Handle platform : platforms) {
      std::uint32_t count = 0;
      if (cl_.devices(platform, all_devices, 0, nullptr, &count) != 0) continue;
      std::vector<Handle> found(count);
      cl_.devices(platform, all_devices, count, found.data(), nullptr);
      all.insert(all.end(), found.begin(), found.end());
    }
    if (number < 0 || static_cast<std::size_t>(number) >= all.size())
      throw Error(ILAW_NOT_FOUND,
                  "OpenCL: device " + std::to_string(number) + " of " + std::to_string(all.size()));
    return all[static_cast<std::size_t>(number)];
  }

  SharedLibrary library_;
  Functions cl_;
  Place place_;
  LoadedImages<OpenclProgram> images_;
  Handle queue_ = nullptr;
  bool owns_context_ = false;
};

}  // namespace

std::unique_ptr<Driver> open_opencl(int number, void* context, void* device_id) {
  return std::make_unique<Opencl>(number, context, device_id);
}

}  // namespace ilaw::device

// CUDA's driver API, of which the few types and functions that are used are declared here.
// SPDX-License-Identifier: BSD-3-Clause
#include "driver.hpp"

namespace ilaw::device {
namespace {

using Result = int;
using Pointer = unsigned long long;
using Handle = void*;

constexpr unsigned block_threads = 128;

struct Functions {
  explicit Functions(const SharedLibrary& library) {
    library.find(init, "cuInit");
    library.find(error_text, "cuGetErrorString");
    library.find(device_count, "cuDeviceGetCount");
    library.find(device_get, "cuDeviceGet");
    library.find(device_name, "cuDeviceGetName");
    library.find(primary_retain, "cuDevicePrimaryCtxRetain");
    library.find(primary_release, "cuDevicePrimaryCtxRelease_v2");
    library.find(push, "cuCtxPushCurrent_v2");
    library.find(pop, "cuCtxPopCurrent_v2");
    library.find(context_device, "cuCtxGetDevice");
    library.find(load, "cuModuleLoadData");
    library.find(unload, "cuModuleUnload");
    library.find(function, "cuModuleGetFunction");
    library.find(launch, "cuLaunchKernel");
    library.find(allocate, "cuMemAlloc_v2");
    library.find(free, "cuMemFree_v2");
    library.find(write, "cuMemcpyHtoDAsync_v2");
    library.find(read, "cuMemcpyDtoHAsync_v2");
    library.find(wait, "cuStreamSynchronize");
  }

  Result (*init)(unsigned);
  Result (*error_text)(Result, const char**);
  Result (*device_count)(int*);
  Result (*device_get)(int*, int);
  Result (*device_name)(char*, int, int);
  Result (*primary_retain)(Handle*, int);
  Result (*primary_release)(int);
  Result (*push)(Handle);
  Result (*pop)(Handle*);
  Result (*context_device)(int*);
  Result (*load)(Handle*, const void*);
  Result (*unload)(Handle);
  Result (*function)(Handle*, Handle, const char*);
  Result (*launch)(Handle, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, Handle,
                   void**, void**);
  Result (*allocate)(Pointer*, std::size_t);
  Result (*free)(Pointer);
  Result (*write)(Pointer, const void*, std::size_t, Handle);
  Result (*read)(void*, Pointer, std::size_t, Handle);
  Result (*wait)(Handle);

  void check(Result result, const std::string& what) const {
    if (result == 0) return;
    const char* text = nullptr;
    error_text(result, &text);
    throw Error(result == 2 ? ILAW_OUT_OF_MEMORY : ILAW_UNSUPPORTED,
                "CUDA: " + what + ": " + (text ? text : "unknown error"));
  }
};

// The context is current in this thread as long as it lives.
class Current {
 public:
  Current(const Functions& cuda, Handle context) : cuda_(cuda) {
    cuda_.check(cuda_.push(context), "the context cannot be used");
  }
  ~Current() {
    Handle before = nullptr;
    cuda_.pop(&before);
  }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  const Functions& cuda_;
};

class CudaModule {
 public:
  CudaModule(const Functions& cuda, Handle context, const ilaw_device_image& image)
      : cuda_(cuda), context_(context) {
    const Current current(cuda_, context_);
    cuda_.check(cuda_.load(&module_, image.begin), "the driver refuses the law's PTX");
  }
  ~CudaModule() {
    Handle before = nullptr;
    if (cuda_.push(context_) != 0) return;
    cuda_.unload(module_);
    cuda_.pop(&before);
  }
  CudaModule(const CudaModule&) = delete;
  CudaModule& operator=(const CudaModule&) = delete;

  Handle kernel(const std::string& name) const {
    const Current current(cuda_, context_);
    Handle found = nullptr;
    cuda_.check(cuda_.function(&found, module_, name.c_str()), "no kernel " + name);
    return found;
  }

 private:
  const Functions& cuda_;
  Handle context_, module_ = nullptr;
};

class CudaKernel : public Kernel {
 public:
  CudaKernel(const Functions& cuda, Handle context, std::shared_ptr<CudaModule> module,
             const std::string& name)
      : cuda_(cuda), context_(context), module_(std::move(module)), function_(module_->kernel(name)) {}

  void launch(void* queue, std::int64_t threads, void* argument, std::size_t /*size*/,
              const std::vector<void*>& /*pointers*/) override {
    const Current current(cuda_, context_);
    const auto blocks = static_cast<unsigned>((threads + block_threads - 1) / block_threads);
    cuda_.check(cuda_.launch(function_, blocks, 1, 1, block_threads, 1, 1, 0, queue, &argument, nullptr),
                "the kernel cannot be launched");
  }

 private:
  const Functions& cuda_;
  Handle context_;
  std::shared_ptr<CudaModule> module_;
  Handle function_;
};

class Cuda : public Driver {
 public:
  Cuda(int number, Handle context) : library_("libcuda.so.1"), cuda_(library_), context_(context) {
    cuda_.check(cuda_.init(0), "no device");
    if (context_) {
      const Current current(cuda_, context_);
      cuda_.check(cuda_.context_device(&device_), "the context has no device");
      return;
    }
    int count = 0;
    cuda_.check(cuda_.device_count(&count), "no device");
    if (number < 0 || number >= count)
      throw Error(ILAW_NOT_FOUND, "CUDA: device " + std::to_string(number) + " of " + std::to_string(count));
    cuda_.check(cuda_.device_get(&device_, number), "no device");
    cuda_.check(cuda_.primary_retain(&context_, device_), "no context");
    owns_context_ = true;
  }
  ~Cuda() override {
    images_.clear();  // while the context lives
    if (owns_context_) cuda_.primary_release(device_);
  }
  Cuda(const Cuda&) = delete;
  Cuda& operator=(const Cuda&) = delete;

  std::string name() const override {
    char text[256] = "";
    cuda_.device_name(text, sizeof text, device_);
    return text;
  }
  void* own_queue() const override { return nullptr; }
  ilaw_kind image_kind() const override { return ILAW_IMAGE_PTX; }
  void* allocate(std::size_t size) override {
    const Current current(cuda_, context_);
    Pointer memory = 0;
    cuda_.check(cuda_.allocate(&memory, size), "memory");
    return reinterpret_cast<void*>(memory);
  }
  void free(void* memory) noexcept override {
    Handle before = nullptr;
    if (cuda_.push(context_) != 0) return;
    cuda_.free(reinterpret_cast<Pointer>(memory));
    cuda_.pop(&before);
  }
  void write(void* queue, void* to, const void* from, std::size_t size) override {
    const Current current(cuda_, context_);
    cuda_.check(cuda_.write(reinterpret_cast<Pointer>(to), from, size, queue), "write");
    cuda_.check(cuda_.wait(queue), "write");
  }
  void read(void* queue, void* to, const void* from, std::size_t size) override {
    const Current current(cuda_, context_);
    cuda_.check(cuda_.read(to, reinterpret_cast<Pointer>(from), size, queue), "read");
    cuda_.check(cuda_.wait(queue), "read");
  }
  std::unique_ptr<Kernel> load(const ilaw_device_image& image, const std::string& kernel) override {
    auto module = images_.get(image, [&] { return std::make_shared<CudaModule>(cuda_, context_, image); });
    return std::make_unique<CudaKernel>(cuda_, context_, std::move(module), kernel);
  }

 private:
  SharedLibrary library_;
  Functions cuda_;
  LoadedImages<CudaModule> images_;
  Handle context_;
  int device_ = 0;
  bool owns_context_ = false;
};

}  // namespace

std::unique_ptr<Driver> open_cuda(int number, void* context) {
  return std::make_unique<Cuda>(number, context);
}

}  // namespace ilaw::device

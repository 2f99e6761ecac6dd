/* points.c - a small explicit code that lives on a GPU, in C99 and OpenCL.
 *
 * Points slide on a plane with friction until they stop. All arrays stay on the device: each step is one
 * kernel of this code and one of the law, on the same queue, and nothing is read back before the end. Usage:
 * points_on_device LIBRARY [POINTS]. It prints the largest error of the distances and the friction's work.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#define CL_TARGET_OPENCL_VERSION 200
#include <CL/cl.h>

#include <ilaw/device.h>
#include <ilaw/loader.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Component 0 is the height over the plane, component 1 lies in it. */
static const char* const source =
    "kernel void move(global double2* u, global const double2* v, global double2* v_previous,\n"
    "                 global double2* v_free, double h, double gravity) {\n"
    "  const size_t i = get_global_id(0);\n"
    "  u[i] += h * v[i];\n"
    "  v_previous[i] = v[i];\n"
    "  v_free[i] = v[i] - (double2)(h * gravity, 0.0);\n"
    "}\n";

static const double h = 0x1p-10, gravity = 10.0, friction = 0.25, mass = 2.0;
enum { STEPS = 1024 };

static double first_speed(int64_t i) { return 0.01 + 0.002 * (double)(i % 1000); }

static void fail(const char* what, const char* why) {
  fprintf(stderr, "points_on_device: %s: %s\n", what, why);
  exit(1);
}
static void check(cl_int result, const char* what) {
  if (result != CL_SUCCESS) fail(what, "OpenCL refuses");
}

/* ---- the solver: its device, its arrays and its kernel */

typedef struct solver {
  cl_context context;
  cl_device_id device;
  cl_command_queue queue;
  cl_kernel move;
  int64_t count;
  double *u, *v, *v_previous, *v_free, *inverse_mass, *impulse, *energy;
} solver;

static double* array(const solver* s, int components) {
  const size_t size = (size_t)s->count * (size_t)components * sizeof(double);
  double* made = clSVMAlloc(s->context, CL_MEM_READ_WRITE, size, 0);
  const double zero = 0.0;
  if (!made) fail("array", "out of memory");
  check(clEnqueueSVMMemFill(s->queue, made, &zero, sizeof zero, size, 0, NULL, NULL), "array");
  return made;
}

static solver create_solver(int64_t count) {
  solver s = {.count = count};
  cl_platform_id platform;
  cl_int result;
  if (clGetPlatformIDs(1, &platform, NULL) != CL_SUCCESS ||
      clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &s.device, NULL) != CL_SUCCESS) {
    printf("no device\n");
    exit(0);
  }
  s.context = clCreateContext(NULL, 1, &s.device, NULL, NULL, &result);
  check(result, "context");
  s.queue = clCreateCommandQueueWithProperties(s.context, s.device, NULL, &result);
  check(result, "queue");
  cl_program program = clCreateProgramWithSource(s.context, 1, (const char**)&source, NULL, &result);
  check(result, "program");
  check(clBuildProgram(program, 1, &s.device, "-cl-std=CL1.2", NULL, NULL), "build");
  s.move = clCreateKernel(program, "move", &result);
  check(result, "kernel");
  check(clReleaseProgram(program), "program");
  s.u = array(&s, 2);
  s.v = array(&s, 2);
  s.v_previous = array(&s, 2);
  s.v_free = array(&s, 2);
  s.inverse_mass = array(&s, 1);
  s.impulse = array(&s, 2);
  s.energy = array(&s, ILAW_ENERGY_COUNT);
  return s;
}

static void start(const solver* s) {
  double* v = calloc((size_t)s->count, 2 * sizeof *v);
  double* inverse_mass = calloc((size_t)s->count, sizeof *inverse_mass);
  if (!v || !inverse_mass) fail("start", "out of memory");
  for (int64_t i = 0; i < s->count; ++i) {
    v[2 * i + 1] = first_speed(i);
    inverse_mass[i] = 1.0 / mass;
  }
  const size_t n = (size_t)s->count * sizeof(double);
  check(clEnqueueSVMMemcpy(s->queue, CL_TRUE, s->v, v, 2 * n, 0, NULL, NULL), "start");
  check(clEnqueueSVMMemcpy(s->queue, CL_TRUE, s->inverse_mass, inverse_mass, n, 0, NULL, NULL), "start");
  free(v);
  free(inverse_mass);
}

static void move(const solver* s) {
  const size_t n = (size_t)s->count;
  const void* const arrays[] = {s->u, s->v, s->v_previous, s->v_free};
  for (cl_uint k = 0; k < 4; ++k) check(clSetKernelArgSVMPointer(s->move, k, arrays[k]), "move");
  check(clSetKernelArg(s->move, 4, sizeof h, &h), "move");
  check(clSetKernelArg(s->move, 5, sizeof gravity, &gravity), "move");
  check(clEnqueueNDRangeKernel(s->queue, s->move, 1, NULL, &n, NULL, 0, NULL, NULL), "move");
}

/* ---- the law */

static ilaw_interface* create_interface(const char* library_name) {
  char message[512];
  ilaw_library* library;
  ilaw_interface* interface;
  const ilaw_argument argument = {.struct_size = sizeof argument, .name = "friction", .number = friction};
  const ilaw_argument* const arguments[] = {&argument};
  const ilaw_setup setup = {.struct_size = sizeof setup,
                            .dimension = 2,
                            .delassus_form = ILAW_DELASSUS_SCALAR,
                            .frame = ILAW_FRAME_LOCAL,
                            .numbers = ILAW_NUMBERS_DOUBLE,
                            .arguments = arguments,
                            .argument_count = 1};
  if (ilaw_library_open(library_name, &library, message, sizeof message) != ILAW_OK) fail("open", message);
  if (ilaw_interface_create(library, NULL, &setup, &interface, message, sizeof message) != ILAW_OK)
    fail("create", message);
  ilaw_library_close(library);
  return interface;
}

/* As on the CPU, with pointers of the device. */
static ilaw_batch describe_batch(const solver* s) {
  return (ilaw_batch){.struct_size = sizeof(ilaw_batch),
                      .node_count = s->count,
                      .velocity_step = h,
                      .position_step = h,
                      .v_free = {s->v_free, NULL, 2, 1},
                      .delassus = {s->inverse_mass, NULL, 1, 0},
                      .gap = {s->u, NULL, 2, 0},
                      .v_previous = {s->v_previous, NULL, 2, 1},
                      .impulse = {s->impulse, NULL, 2, 1},
                      .velocity = {s->v, NULL, 2, 1}, /* v_free with the impulse: the next step's v */
                      .energy = {s->energy, NULL, ILAW_ENERGY_COUNT, 1}};
}

/* ---- what is known of the motion: each step takes mu g h off the speed, the last one what is left */

static double distance(double speed) {
  double way = 0.0;
  for (; speed > 0.0; speed -= friction * gravity * h) way += h * speed;
  return way;
}

static double largest_error(const solver* s) {
  double *u = malloc((size_t)s->count * 2 * sizeof *u), worst = 0.0;
  if (!u) fail("end", "out of memory");
  check(clEnqueueSVMMemcpy(s->queue, CL_TRUE, u, s->u, (size_t)s->count * 2 * sizeof *u, 0, NULL, NULL),
        "end");
  for (int64_t i = 0; i < s->count; ++i) {
    const double error = fabs(u[2 * i + 1] - distance(first_speed(i)));
    if (!(error <= worst)) worst = error;
    if (u[2 * i] != 0.0) fail("end", "a point has left the plane");
  }
  free(u);
  return worst;
}

int main(int argc, char** argv) {
  if (argc < 2) fail("usage", "points_on_device LIBRARY [POINTS]");
  const solver s = create_solver(argc > 2 ? atoll(argv[2]) : 1000);
  ilaw_interface* interface = create_interface(argv[1]);
  ilaw_device* device;
  ilaw_launcher* launcher;
  char message[512];
  if (ilaw_device_open_in(ILAW_DRIVER_OPENCL, s.context, s.device, &device, message, sizeof message) !=
      ILAW_OK)
    fail("device", message);
  if (ilaw_launcher_create(device, ilaw_interface_law(interface), ilaw_interface_instance(interface), s.count,
                           &launcher, message, sizeof message) != ILAW_OK)
    fail("launcher", message);
  start(&s);
  ilaw_batch batch = describe_batch(&s);
  ilaw_report report = {.struct_size = sizeof report};
  double work = 0.0, expected = 0.0;
  for (int n = 0; n < STEPS; ++n) {
    move(&s);
    batch.time = (n + 1) * h;
    if (ilaw_launcher_evaluate(launcher, s.queue, &batch, n + 1 == STEPS, &report) != ILAW_OK)
      fail("evaluate", report.reason);
    if (n % 256 == 0) { /* energy, where it is wanted: this waits */
      double sums[ILAW_ENERGY_COUNT];
      if (ilaw_launcher_energy(launcher, s.queue, sums) != ILAW_OK) fail("energy", "no sum");
      if (n == 0) work = sums[ILAW_ENERGY_FRICTION];
    }
  }
  if (ilaw_launcher_report(launcher, s.queue, &report) != ILAW_OK) fail("report", report.reason);
  for (int64_t i = 0; i < s.count; ++i) { /* of the first step */
    const double before = first_speed(i), left = before - friction * gravity * h,
                 after = left > 0.0 ? left : 0.0;
    expected += 0.5 * mass * (before * before - after * after);
  }
  printf("%s: %lld points, largest error %.1e m, work of the first step off by %.1e\n",
         ilaw_device_name(device), (long long)s.count, largest_error(&s), fabs(work / expected - 1.0));
  ilaw_launcher_destroy(launcher);
  ilaw_device_close(device);
  ilaw_interface_destroy(interface);
  return 0;
}

/* ilaw.h - the interface-law ABI, version 1.0.
 * An interface law answers one question per interface node of an explicit dynamics code: given the
 * velocity v_free that the node would have without interface, and the local inverse mass H (the
 * Delassus operator), which impulse r does the interface exert?
 *
 *     v = v_free + H r ,     R(v, r; gap, state) = 0
 * A law library (plugin) exports the one symbol ILAW_ENTRY_NAME. It gives a constant description of the
 * library and of its laws; each law has five functions (create, destroy, info, initialise, evaluate).
 *
 * Conventions, everywhere in this file
 *  - Units are the host's own consistent units; parameter units are given for SI.
 *  - The normal n points from the obstacle into the body. gap > 0 is open, v_N = n.v > 0 opens,
 *    r_N > 0 pushes the body away, r_N < 0 is adhesive.
 *  - In the local frame, component 0 is normal, components 1 and 2 are tangential.
 *  - Ownership: the library owns every description and string it returns, for as long as it stays loaded.
 *    The host owns every array of a batch; the library keeps no pointer past the call that received it.
 *  - No function throws, prints, exits or raises a signal. evaluate and initialise leave the floating-point
 *    environment (exception flags, trap masks, rounding mode, flush-to-zero) as they found it, and give the
 *    same bits whatever it is.
 *  - create, initialise and evaluate need at most ILAW_STACK_SIZE bytes of stack.
 *  - Threads: each function says from where it may be called. [any-thread]: from any thread, at the same time
 *    as any other call. [exclusive]: from any thread, while no other call works on the same instance.
 *
 * Growth (all rules, with reasons: docs/abi.md)
 *  - Every struct but ilaw_input and ilaw_output starts with struct_size: its writer's sizeof. Minor versions
 *    append members at the end; an absent member is zero, and zero means what 1.0 did. A struct smaller than
 *    its ILAW_..._SIZE_1_0 is refused. Nobody writes beyond the struct_size of the other side.
 *  - A flag or kind set by the host is a request: a library that does not know it refuses. So do inputs and
 *    balance_inputs of an instance, and the host refuses. All other bits of a library are information.
 *  - Pointers to arrays of structs are arrays of pointers, since a struct may grow.
 *  - New functions are extensions, asked for by name: ilaw/ext/, drafts in ilaw/ext/draft/.
 * Pure C99, clean as C++17, needs nothing but <stdint.h> and <stddef.h>.
 * Formulation: Moreau (1988), Unilateral contact and dry friction in finite freedom dynamics; Fekak, Brun,
 * Gravouil, Depale (2017), heterogeneous asynchronous time integrator for nonsmooth dynamics (CD-Lagrange).
 * SPDX-License-Identifier: BSD-3-Clause
 */
#ifndef ILAW_ILAW_H
#define ILAW_ILAW_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { ILAW_ABI_MAJOR = 1, ILAW_ABI_MINOR = 0, ILAW_STACK_SIZE = 1 << 16 };
/* The major version is part of the name: a library for ABI 2 is not found by a host of ABI 1. */
#define ILAW_ENTRY ilaw_plugin_v1
#define ILAW_ENTRY_NAME "ilaw_plugin_v1"

#if defined(_WIN32)
#define ILAW_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define ILAW_EXPORT __attribute__((visibility("default")))
#else
#define ILAW_EXPORT
#endif

/* Calling convention of every function, whatever flags its caller was compiled with. */
#if defined(_WIN32) && !defined(_WIN64)
#define ILAW_CALL __cdecl
#else
#define ILAW_CALL
#endif

/* Types of results, statuses, kinds (one of an enumeration) and masks (any of its bits). */
typedef int32_t ilaw_result;           /* ILAW_OK ... */
typedef uint8_t ilaw_status;           /* ILAW_FREE ... */
typedef uint32_t ilaw_kind;            /* one of ILAW_KIND_*: of a parameter, a value, a state variable */
typedef uint32_t ilaw_dimensions;      /* mask of ILAW_DIMENSION_* */
typedef uint32_t ilaw_delassus_form;   /* one of ILAW_DELASSUS_* */
typedef uint32_t ilaw_delassus_forms;  /* mask of them */
typedef uint32_t ilaw_frame;           /* one of ILAW_FRAME_* */
typedef uint32_t ilaw_frames;          /* mask of them */
typedef uint32_t ilaw_number_type;     /* one of ILAW_NUMBERS_* */
typedef uint32_t ilaw_number_types;    /* mask of them */
typedef uint32_t ilaw_inputs;          /* mask of ILAW_INPUT_* */
typedef uint32_t ilaw_outputs;         /* mask of ILAW_OUTPUT_* */
typedef uint32_t ilaw_capabilities;    /* mask of ILAW_CAN_* */
typedef uint32_t ilaw_permissions;     /* mask of ILAW_MAY_* */
typedef uint32_t ilaw_parameter_flags; /* mask of ILAW_FLAG_*, of a parameter */
typedef uint32_t ilaw_variable_flags;  /* mask of ILAW_FLAG_*, of a state variable */
typedef uint64_t ilaw_batch_flags;     /* mask of ILAW_BATCH_* */

/* Codes that functions return. Negative: nothing was done, and the message says why. */
enum {
  ILAW_OK = 0,
  ILAW_BAD_NODES = 1,          /* evaluate: some nodes had bad input, see ilaw_report; the others are done */
  ILAW_INVALID_ARGUMENT = -1,  /* the call itself is wrong: null pointer, struct too small, count < 0 */
  ILAW_INVALID_PARAMETER = -2, /* a parameter is unknown, missing, out of range or wrongly combined */
  ILAW_UNSUPPORTED = -3,       /* dimension, form of H, input or flag that this law does not serve */
  ILAW_OUT_OF_MEMORY = -4,
  ILAW_NOT_FOUND = -5,   /* loader: no such library or law */
  ILAW_BAD_LIBRARY = -6, /* loader: not a law library, another major version, or a broken description */
};

/* Dimensions served, a bit mask. */
enum { ILAW_DIMENSION_1 = 1 << 1, ILAW_DIMENSION_2 = 1 << 2, ILAW_DIMENSION_3 = 1 << 3 };

/* Form of H at a node, with d the dimension. Components are stored in this order:
 *   SCALAR    1 value:        H = h I (a lumped mass m gives h = 1/m)
 *   DIAGONAL  d values:       H_00, H_11, H_22, in the axes of the vectors
 *   FULL      d(d+1)/2 values: 1D H_00; 2D H_00 H_11 H_01; 3D H_00 H_11 H_22 H_01 H_02 H_12
 *   TRANSVERSE 2 values:      normal h_N and tangential h_T, H = h_N n n^T + h_T (I - n n^T), in any axes;
 *     2 values in dimension 1 as well, where h_T is not read
 *   TRANSVERSE_SPIN 5 values, dimension 3: h_N h_T k j_N j_T, with H as in TRANSVERSE and
 *     v = v_free + H r + k n x m ,   w = w_free + J m - k n x r ,   J = j_N n n^T + j_T (I - n n^T)
 * for the relative velocity v at the contact point, the relative spin w and the moment m. A sphere of radius
 * R on a fixed obstacle has h_N = 1/M, h_T = 1/M + R^2/I, k = R/I, j_N = j_T = 1/I. k changes its sign with
 * n. A law serves the forms in its mask. */
enum {
  ILAW_DELASSUS_SCALAR = 1,
  ILAW_DELASSUS_DIAGONAL = 2,
  ILAW_DELASSUS_FULL = 4,
  ILAW_DELASSUS_TRANSVERSE = 8,
  ILAW_DELASSUS_TRANSVERSE_SPIN = 16,
};

/* Axes in which vectors and H are given, right-handed. LOCAL: component 0 is normal, 1 and 2 are tangential.
 * GLOBAL: the host's axes; each node has a unit normal and, optionally, a unit tangent. */
enum { ILAW_FRAME_LOCAL = 1, ILAW_FRAME_GLOBAL = 2 };

/* Number type of the arrays of a batch; state is always double. Laws compute in double: a float result is the
 * double result rounded once, and an impulse of 2^126 or more is bad input of its node. */
enum { ILAW_NUMBERS_DOUBLE = 1, ILAW_NUMBERS_FLOAT = 2 };

/* Arrays of a batch that a law reads, a bit mask. v_free and delassus are always read. V_SMOOTH is read where
 * the host gives it; the others must be given. */
enum {
  ILAW_INPUT_GAP = 1 << 0,
  ILAW_INPUT_V_PREVIOUS = 1 << 1,
  ILAW_INPUT_AREA = 1 << 2,
  ILAW_INPUT_NORMAL = 1 << 3,  /* always, and only, in the global frame */
  ILAW_INPUT_TANGENT = 1 << 4, /* the law tells its two tangential axes apart (global frame only) */
  ILAW_INPUT_V_SMOOTH = 1 << 5,
};

/* Optional arrays that a law can write, a bit mask; impulse and state are always written. */
enum { ILAW_OUTPUT_VELOCITY = 1 << 0, ILAW_OUTPUT_STATUS = 1 << 1, ILAW_OUTPUT_ENERGY = 1 << 2 };

/* Further abilities of a law, a bit mask: r_N may be negative; the stored part of the energy may not be 0;
 * bonds hold or break as the flags of a batch say. */
enum { ILAW_CAN_ADHERE = 1 << 0, ILAW_CAN_STORE_ENERGY = 1 << 1, ILAW_CAN_HOLD_BONDS = 1 << 2 };

/* Flags of a batch, none or one, for instances that can hold bonds. A rupture sheds its load on the
 * neighbours, so the bond would hold if it were judged again: a host that solves contacts together evaluates
 * with HOLD_BONDS first, and later with BREAK_BONDS those that broke at the solution.
 *   HOLD_BONDS   a bond that held before the step holds, whatever its impulse
 *   BREAK_BONDS  it breaks in this step, whatever its impulse: status ILAW_BROKEN */
enum { ILAW_BATCH_HOLD_BONDS = 1 << 0, ILAW_BATCH_BREAK_BONDS = 1 << 1 };

/* The host may skip a node that is out of reach and whose state is as initialise left it (FRESH), or whose
 * last status was ILAW_FREE (FREE); none by default. The law promises that evaluate would have given r = 0,
 * no energy, no amounts, the same status and the same state, bit for bit. */
enum { ILAW_MAY_SKIP_FRESH = 1 << 0, ILAW_MAY_SKIP_FREE = 1 << 1 };

/* A node is out of reach if g > 0 and g + position_step * v_N > 0, with g = gap - gap_offset (or the gap
 * itself) and v_N = v_free_0 in the local frame, (n_0 v_free_0 + n_1 v_free_1) + n_2 v_free_2 in the global
 * one; and if the same is true for v_smooth where it is given. In double precision, in this order, each
 * operation rounded (no fused multiply-add), so that law and host agree to the last bit. */

/* Kind of a parameter: INTEGER is a whole number, given as a double; CHOICE is one of the listed texts. */
enum { ILAW_KIND_NUMBER = 0, ILAW_KIND_INTEGER = 1, ILAW_KIND_CHOICE = 2 };

/* Flags of a parameter, a bit mask. */
enum {
  ILAW_FLAG_REQUIRED = 1 << 0,         /* has no default */
  ILAW_FLAG_EXCLUDES_MINIMUM = 1 << 1, /* the value must be larger than minimum */
  ILAW_FLAG_ALLOWS_INFINITY = 1 << 2,  /* +infinity is an ordinary value */
  ILAW_FLAG_ALLOWS_PER_NODE = 1 << 3,  /* may be given per node */
  /* A field of the host's model (temperature, fluid_pressure: glossary in docs/abi.md), at the time of the
   * batch. A host that has a field of this name passes it per node, unless its user gave a value. */
  ILAW_FLAG_FIELD = 1 << 4,
  ILAW_FLAG_NEEDS_SPINS = 1 << 5, /* create refuses it for a form of H without spins */
};

/* Kind of the value of a parameter. TABLE: over one to three axes, linear along each, constant beyond its
 * ends. PER_NODE: one value per node, given with every batch. */
enum {
  ILAW_KIND_VALUE_NUMBER = 0,
  ILAW_KIND_VALUE_TEXT = 1,
  ILAW_KIND_VALUE_TABLE = 2,
  ILAW_KIND_VALUE_PER_NODE = 3,
};

/* Kind of a state variable. */
enum {
  ILAW_KIND_SCALAR = 0,     /* one double */
  ILAW_KIND_VECTOR = 1,     /* d doubles: components in the local frame of the node */
  ILAW_KIND_HISTORY = 2,    /* any number of doubles, meaningful to the law alone, in the local frame */
  ILAW_KIND_AXIS = 3,       /* d doubles: a unit vector in the host's axes, which a host that turns its whole
                               model must turn, too; in the global frame without tangents only */
  ILAW_KIND_TANGENTIAL = 4, /* d-1 doubles: a vector without normal component, in the local frame */
};

/* Flags of a state variable, a bit mask. INTERNAL: the law's bookkeeping, not for pictures and tables. */
enum { ILAW_FLAG_INTERNAL = 1 << 0 };

/* Status of a node after a step; ABI 1 has these eight for ever. Another number means a broken library: a
 * host takes it for ILAW_BAD_INPUT, and never uses a status as an index unchecked. */
enum {
  ILAW_FREE = 0,   /* no impulse */
  ILAW_CLOSED = 1, /* pushed, no friction */
  ILAW_STICK = 2,
  ILAW_SLIP = 3,
  ILAW_BONDED = 4,
  ILAW_BROKEN = 5, /* the bond broke at this step */
  ILAW_HEALED = 6, /* a bond formed at this step */
  ILAW_BAD_INPUT = 7,
  ILAW_STATUS_COUNT = 8,
};

/* Components of the energy output, per node and step: dissipated by friction, by impact, by rupture, and
 * stored at the end of the step (a level, not an increment). ABI 1 has these four for ever. The work of the
 * impulse over the step is r.(v_previous + v)/2, exactly, in a central-difference host, and the work of the
 * moment is m.(spin_previous + spin)/2; their sum divides into these parts. Dissipated parts are never
 * negative; a part that overflows is +infinity, none is NaN. */
enum {
  ILAW_ENERGY_FRICTION = 0,
  ILAW_ENERGY_IMPACT = 1,
  ILAW_ENERGY_RUPTURE = 2,
  ILAW_ENERGY_STORED = 3,
  ILAW_ENERGY_COUNT = 4
};

/* ---- description -------------------------------------------------------------------------------- */

/* A parameter of a law. Texts are never null; they may be empty. */
typedef struct ilaw_parameter {
  uint32_t struct_size;
  ilaw_kind kind;       /* ILAW_KIND_NUMBER ... */
  const char* name;     /* lower case, digits, underscore: what users type */
  const char* symbol;   /* as in the law's page */
  const char* unit;     /* SI, "1" when it has none */
  const char* doc;      /* one sentence */
  double minimum;       /* smallest value allowed */
  double maximum;       /* largest finite value allowed */
  double default_value; /* for a choice, its index in choices */
  ilaw_parameter_flags flags;
  uint32_t choice_count;
  const char* const* choices; /* choice_count texts, null unless kind is CHOICE */
  const char* const* axes; /* axis_count names over which it may be a table: "time", a field of this law, or a
                              quantity that doc explains ("slip_speed", "pressure"); null: never a table */
  uint32_t axis_count;
  uint32_t reserved; /* 0 */
} ilaw_parameter;

/* A state variable. The state of a node is the concatenation of its variables, in this order. */
typedef struct ilaw_state_variable {
  uint32_t struct_size;
  ilaw_kind kind;   /* ILAW_KIND_SCALAR ... */
  const char* name; /* lower case, digits, underscore */
  const char* unit;
  const char* doc;
  uint64_t count; /* doubles: 1 for SCALAR, d for VECTOR and AXIS, d-1 for TANGENTIAL; known from the instance
                     for HISTORY */
  ilaw_variable_flags flags;
  uint32_t reserved; /* 0 */
} ilaw_state_variable;

/* A scalar that the law gives per node and step: the amount of this step, 0 where nothing happened, never a
 * level. Glossary in docs/abi.md: heat, counterpart_heat [J], wear [m]. */
typedef struct ilaw_amount {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  const char* name;
  const char* unit;
  const char* doc;
} ilaw_amount;

/* An axis of a table, whose grid has at most ILAW_TABLE_MAX_VALUES points. */
enum { ILAW_TABLE_MAX_VALUES = 1 << 24 };
typedef struct ilaw_axis {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  const char* name;
  const double* points; /* count, finite, strictly increasing */
  uint64_t count;       /* at least 1 */
} ilaw_axis;

/* A parameter with its value, for create. */
typedef struct ilaw_argument {
  uint32_t struct_size;
  ilaw_kind kind;       /* ILAW_KIND_VALUE_* */
  const char* name;     /* of the parameter */
  double number;        /* NUMBER; infinity where the parameter allows it */
  const char* text;     /* TEXT: the choice; else null */
  const double* values; /* TABLE: one per point of the grid, the last axis varies fastest; else null */
  const ilaw_axis* const* axes; /* TABLE: axis_count, each name once; else null. create refuses an axis
                                   that is a field without a value or per-node array */
  uint32_t axis_count;          /* TABLE: 1 to 3; else 0 */
  uint32_t reserved;            /* 0 */
} ilaw_argument;

/* The use of an instance. Dimension, form, frame and numbers: each exactly one entry of the law's mask. */
typedef struct ilaw_setup {
  uint32_t struct_size;
  uint32_t dimension;                    /* 1, 2 or 3 */
  ilaw_delassus_form delassus_form;      /* the form every batch will have */
  ilaw_frame frame;                      /* the frame every batch will have */
  uint64_t flags;                        /* 0: none is defined in 1.0; an unknown bit is refused */
  const ilaw_argument* const* arguments; /* argument_count pointers; may be null when 0 */
  uint32_t argument_count;
  uint32_t has_tangent;     /* 1: batches in the global frame will carry a tangent */
  ilaw_number_type numbers; /* of the arrays of every batch */
  uint32_t reserved;        /* 0 */
} ilaw_setup;

/* An instance of a law: its checked parameters. Opaque, immutable, usable from any number of threads. */
typedef struct ilaw_instance ilaw_instance;

/* Needs of an instance with its parameters: often less than the law in general. */
typedef struct ilaw_instance_info {
  uint32_t struct_size;
  ilaw_inputs inputs;         /* read by every evaluate */
  ilaw_inputs balance_inputs; /* read besides when energy or an amount is asked for */
  uint32_t state_variable_count;
  uint64_t state_size;                               /* doubles per node; may be 0 */
  const ilaw_state_variable* const* state_variables; /* owned by the instance; counts sum to state_size */
  const char* const* per_node_parameters; /* names of parameters given per node, in the order of the batch */
  uint32_t per_node_parameter_count;
  ilaw_capabilities capabilities; /* what the law can do with these parameters */
  /* The law raises it whenever it interprets a stored state differently. A host stores it with every state,
   * beside library, law, parameters and state_size, and discards a state of another version. */
  uint32_t state_version;
  ilaw_permissions permissions;
  const ilaw_amount* const* amounts; /* that it can give, in the order of the batch */
  uint32_t amount_count;
  uint32_t reserved; /* 0 */
} ilaw_instance_info;

/* ---- batch -------------------------------------------------------------------------------------- */

/* Component c of node i stands at values[i * node_stride + c * component_stride] (strides in elements).
 * AoS (3,n): strides 3 and 1. SoA: strides 1 and n. A node stride of 0 gives all nodes the same value.
 * The setup's numbers decide which pointer is set, values or floats; the other one is null. Both null: the
 * array is absent. State has values alone. A number type of a later version would use values, cast. */
typedef struct ilaw_input {
  const double* values;
  const float* floats;
  int64_t node_stride;
  int64_t component_stride;
} ilaw_input;

/* As ilaw_input, written to; a node stride of 0 only for a batch of one node. Neither ever grows. */
typedef struct ilaw_output {
  double* values;
  float* floats;
  int64_t node_stride;
  int64_t component_stride;
} ilaw_output;

/* Arguments of evaluate. d is the dimension, s the state size of the instance.
 * Outputs may not overlap inputs or each other, except that state_out may be state_in. Time and steps are
 * common to all nodes; arrays with values per node may be appended by a later minor version. */
typedef struct ilaw_batch {
  uint32_t struct_size;
  int32_t index_base;     /* first value of an index: 0 in C, 1 in Fortran */
  ilaw_batch_flags flags; /* mask of ILAW_BATCH_*; an unknown bit is refused */
  int64_t node_count;     /* nodes to evaluate */
  const int32_t* index;   /* null: nodes 0 .. node_count-1; else node index[k] - index_base for each k, each
                             node once, none below index_base; only these are read and written */
  const int64_t* index64; /* the same in 64 bits, for hosts that have such lists; not both */
  double time;            /* t_{n+1}, of the configuration that the gaps belong to */
  double velocity_step;   /* > 0: an impulse is a force times it */
  double position_step;   /* > 0: a predicted gap is gap + position_step * v_N */
  ilaw_input v_free;      /* d: velocity without this contact's impulse, relative to the obstacle [m/s] */
  ilaw_input v_smooth;   /* d, optional: the same without the impulse of any contact in this step: restitution
                            decides with it whether a contact lands. Absent: v_free */
  ilaw_input delassus;   /* H, see ILAW_DELASSUS_* [1/kg]; symmetric positive definite */
  ilaw_input gap;        /* 1: signed distance at time [m] */
  ilaw_input gap_offset; /* 1, optional: subtracted from the gap (thickness, initial slack) [m] */
  ilaw_input v_previous; /* d: half-step velocity before this step, relative to the obstacle [m/s] */
  ilaw_input spin_free;  /* 3, where the form of H has spins: relative, without this contact's moment */
  ilaw_input spin_previous; /* 3, with spins: before this step; read where v_previous is */
  ilaw_input area;          /* 1: tributary area [m^2], >= 0 */
  ilaw_input normal;  /* d, global frame: unit normal, to 1e-6 of its squared length. A pair of bodies keeps
                         its roles, and so the sense of its normal, for life */
  ilaw_input tangent; /* d, global frame, optional: unit tangent, orthogonal to the normal, both to 1e-6;
                         turns with the material. Without it history vectors are carried from normal to
                         normal by the shortest rotation; by a half turn about the stored tangent where the
                         normal has turned to its opposite */
  const ilaw_input* per_node_parameters; /* 1 each, as many as the instance info says; may be null when 0 */
  ilaw_input state_in;                   /* s */
  ilaw_output state_out;                 /* s; may be the array of state_in, with the same strides */
  ilaw_output impulse;                   /* d: r [N.s] */
  ilaw_output moment;                    /* 3, with spins: m, on the body [N.m.s]; always written */
  ilaw_output velocity;                  /* d, optional: v = v_free + H r [m/s] */
  ilaw_output spin;                      /* 3, with spins, optional: w [rad/s] */
  ilaw_output energy;                    /* four: ILAW_ENERGY_*, optional [J] */
  ilaw_status* status;                   /* optional: per node, at status[i * status_stride] */
  int64_t status_stride;
  const ilaw_output* amounts; /* 1 each, in the order of the instance info; an absent one is not wanted; null:
                                 none is */
} ilaw_batch;

/* Findings of evaluate and initialise. The caller sets struct_size and zeroes the rest. */
typedef struct ilaw_report {
  uint32_t struct_size;
  uint32_t reserved;      /* 0 */
  int64_t bad_count;      /* nodes with bad input */
  int64_t first_bad_node; /* the node number (without index_base) of the first in the batch, -1 when none */
  const char* reason;     /* of that node, or why the call was refused; static text, null when none */
  double stable_velocity_step; /* largest velocity_step (with a position_step as long) at which the law, as a
                                  spring between the host's masses, is stable at every good node, for the step
                                  control of explicit codes. Infinity: no limit; 0: the library did not say */
} ilaw_report;

/* ---- laws and libraries ------------------------------------------------------------------------- */

/* Functions of a law, described at the members of ilaw_law. */
typedef ilaw_result(ILAW_CALL* ilaw_create_function)(const char* id, const ilaw_setup* setup,
                                                     ilaw_instance** instance, char* message,
                                                     size_t message_size);
typedef void(ILAW_CALL* ilaw_destroy_function)(ilaw_instance* instance);
typedef ilaw_result(ILAW_CALL* ilaw_info_function)(const ilaw_instance* instance, ilaw_instance_info* info);
typedef ilaw_result(ILAW_CALL* ilaw_batch_function)(const ilaw_instance* instance, const ilaw_batch* batch,
                                                    ilaw_report* report);
typedef const void*(ILAW_CALL* ilaw_extension_function)(const char* name);

/* One law. All function pointers are set, but extension: null says that there are none. */
typedef struct ilaw_law {
  uint32_t struct_size;
  ilaw_dimensions dimensions;
  ilaw_delassus_forms delassus_forms;
  ilaw_frames frames;
  ilaw_number_types numbers;
  ilaw_inputs inputs; /* all that it may read, for some parameters */
  ilaw_outputs outputs;
  ilaw_capabilities capabilities;
  ilaw_permissions permissions;  /* with any parameters; an instance may give more */
  uint32_t reserved;             /* 0 */
  const char* id;                /* lower case, digits, underscore; unique in the library */
  const char* title;             /* a few words */
  const char* doc;               /* one paragraph */
  const char* const* references; /* reference_count texts: author, year, title */
  const ilaw_parameter* const* parameters;
  const ilaw_state_variable* const* state_variables; /* counts for dimension 3 and default parameters */
  uint32_t reference_count;
  uint32_t parameter_count;
  uint32_t state_variable_count;
  uint32_t amount_count;
  const ilaw_amount* const* amounts;

  /* [any-thread] Checks the setup and makes an instance of the law `id`: this law's id, so that one function
   * can serve all laws of a library. On failure *instance is null and message (message_size bytes, may be
   * null when 0) says which parameter, its value and what is allowed. Returns ILAW_OK, ILAW_INVALID_ARGUMENT,
   * ILAW_INVALID_PARAMETER, ILAW_UNSUPPORTED, ILAW_OUT_OF_MEMORY. */
  ilaw_create_function create;

  /* [exclusive] Ends an instance; null is allowed. */
  ilaw_destroy_function destroy;

  /* [any-thread] Fills info up to info->struct_size, which the caller sets. The pointers live as long as the
   * instance. Returns ILAW_OK or ILAW_INVALID_ARGUMENT. */
  ilaw_info_function info;

  /* [any-thread] Writes the initial state of the nodes of a batch: reads flags, node_count, index or index64,
   * index_base, time, area and normal, tangent (as the instance needs them), per_node_parameters; writes
   * state_out. The rest of the batch may be zero. Returns as evaluate. */
  ilaw_batch_function initialise;

  /* [any-thread] One step of a batch; pure: no allocation, lock, I/O or global. The result at a node depends
   * on that node's inputs and the scalars of the batch alone, bit for bit: not on the other nodes, their
   * order, the layout, threads, the processor, or which outputs are asked for. A node with bad input, of
   * which a state that the law cannot have written is one, gets r = 0, state_out = state_in, status
   * ILAW_BAD_INPUT, energy and amounts 0, velocity = v_free, m = 0 and spin = spin_free; the others are
   * evaluated as ever. report may be null. Returns ILAW_OK, ILAW_BAD_NODES, or ILAW_INVALID_ARGUMENT or
   * ILAW_UNSUPPORTED with nothing written. */
  ilaw_batch_function evaluate;

  /* [any-thread] The extension of this name: a table of functions of the type that the extension's header
   * defines; null where the law has none. Names are owner.topic/version: "ilaw.profile/1", "acme.thing/2". */
  ilaw_extension_function extension;
} ilaw_law;

/* A library of laws. */
typedef struct ilaw_plugin {
  uint32_t struct_size;
  uint16_t abi_major; /* ILAW_ABI_MAJOR it was compiled with */
  uint16_t abi_minor;
  const char* name;
  const char* version;
  const char* vendor;
  const char* licence; /* SPDX identifier where there is one */
  const ilaw_law* const* laws;
  uint32_t law_count;
  uint32_t reserved;                 /* 0 */
  ilaw_extension_function extension; /* [any-thread] as a law's, of the whole library; null: none */
} ilaw_plugin;

/* [any-thread] The exported function. Returns the same constant description at every call. */
typedef const ilaw_plugin*(ILAW_CALL* ilaw_entry_function)(void);
#ifdef ILAW_BUILDING_PLUGIN
ILAW_EXPORT const ilaw_plugin* ILAW_CALL ILAW_ENTRY(void);
#endif

/* ---- sizes -------------------------------------------------------------------------------------- */

/* Size of each struct in version 1.0, by its last member: the least that a reader accepts. */
#define ILAW_SIZE_TO(type, member) (offsetof(type, member) + sizeof(((type*)0)->member))
#define ILAW_PARAMETER_SIZE_1_0 ILAW_SIZE_TO(ilaw_parameter, reserved)
#define ILAW_STATE_VARIABLE_SIZE_1_0 ILAW_SIZE_TO(ilaw_state_variable, reserved)
#define ILAW_AMOUNT_SIZE_1_0 ILAW_SIZE_TO(ilaw_amount, doc)
#define ILAW_AXIS_SIZE_1_0 ILAW_SIZE_TO(ilaw_axis, count)
#define ILAW_ARGUMENT_SIZE_1_0 ILAW_SIZE_TO(ilaw_argument, reserved)
#define ILAW_SETUP_SIZE_1_0 ILAW_SIZE_TO(ilaw_setup, reserved)
#define ILAW_INSTANCE_INFO_SIZE_1_0 ILAW_SIZE_TO(ilaw_instance_info, reserved)
#define ILAW_BATCH_SIZE_1_0 ILAW_SIZE_TO(ilaw_batch, amounts)
#define ILAW_REPORT_SIZE_1_0 ILAW_SIZE_TO(ilaw_report, stable_velocity_step)
#define ILAW_LAW_SIZE_1_0 ILAW_SIZE_TO(ilaw_law, extension)
#define ILAW_PLUGIN_SIZE_1_0 ILAW_SIZE_TO(ilaw_plugin, extension)

#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* ILAW_ILAW_H */

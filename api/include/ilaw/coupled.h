/* coupled.h - the impulses of contacts that share bodies: grains in a pile, bonded pieces, corners, facets.
 *
 * An impulse of one contact changes v_free of every other contact at the same body, so one evaluate per
 * contact does not solve them: a stack sinks, pieces tied to each other explode. ilaw_coupled_solve finds
 * impulses with which all laws hold at once, by iterations over the pure evaluate of each law. It chooses its
 * method; docs/hosts/coupled.md describes the present one. A law sees any H and any part of a group in a
 * call. The same input gives the same bits. Other orders of contacts and other numbers of ranks give
 * solutions that agree to the tolerance, if the solution is unique.
 *
 * Structs grow as those of ilaw.h: struct_size first, new members at the end, absent means zero.
 * Threads: one solver serves one solve at a time and refuses a second one; different solvers are independent.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#ifndef ILAW_COUPLED_H
#define ILAW_COUPLED_H

#include <ilaw/ilaw.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(ILAW_BUILDING_SHARED_COUPLED)
#pragma GCC visibility push(default)
#endif

/* All arrays of a call hold doubles, those of contacts and batches as well. Bodies that contacts name:
 * grains, or nodes of a mesh. With ranks: first the bodies that this rank owns, then copies of bodies that
 * other ranks own. Masses and velocities are needed at both. In dimensions 1 and 2 bodies do not rotate; a
 * plane code with rotation passes three components. */
typedef struct ilaw_bodies {
  uint32_t struct_size;
  uint32_t dimension;          /* d: 1, 2 or 3, that of all instances */
  int64_t count;               /* bodies, copies included */
  int64_t owned_count;         /* number of owned bodies; without ranks: count */
  const int64_t* id;           /* optional: global number of each body. Iterations visit contacts in the order
                                  of these numbers, not in that of the arrays. Null: the index */
  ilaw_input inverse_mass;     /* 1 or d [1/kg]; 0: immovable, along this axis. Component stride 0: one value.
                                  d values: slides and driven axes, in the host's axes. A contact whose law
                                  must push a body along an axis without freedom is refused */
  ilaw_input inverse_inertia;  /* optional, d = 3: xx yy zz xy xz yz in the host's axes [1/(kg m^2)];
                                  component stride 0: one value, a sphere's. Absent: no rotation */
  ilaw_input v_free;           /* d: velocity without contacts [m/s] */
  ilaw_input spin_free;        /* 3, with inertia: angular velocity without contacts [1/s] */
  ilaw_input v_previous;       /* d: half-step velocity before the step; may be absent if no law reads it */
  ilaw_input spin_previous;    /* 3, with inertia and v_previous: the same of the angular velocity */
  ilaw_output velocity;        /* d, optional: v_free with all impulses; may be the array of v_free */
  ilaw_output spin;            /* 3, optional: may be the array of spin_free */
  ilaw_output impulse;         /* d, optional: sum of the impulses at the body [N.s] */
  ilaw_output angular_impulse; /* 3, optional: their moment about its centre, with the moments [N.m.s] */
} ilaw_bodies;

/* The contacts that have one law. A contact has one body on either side, or a weighted set of bodies, such as
 * the nodes of a facet: its velocity is sum w_i v_i over the first set, less the same over the counterparts,
 * and its impulse r acts at body i with w_i r. */
typedef struct ilaw_contacts {
  uint32_t struct_size;
  ilaw_delassus_form delassus_form; /* the instance was created with: ILAW_DELASSUS_SCALAR where nothing
                                    rotates, ILAW_DELASSUS_TRANSVERSE for spheres with arms along the normal,
                                    ILAW_DELASSUS_TRANSVERSE_SPIN for the same with moments (one body on
                                    either side, no weights), else ILAW_DELASSUS_FULL */
  const ilaw_law* law;              /* ilaw_interface_law, ilaw_interface_instance of an interface that was */
  const ilaw_instance* instance;    /* created for ILAW_FRAME_GLOBAL and ILAW_NUMBERS_DOUBLE */
  /* As for evaluate, but without v_free, v_smooth, delassus, v_previous, velocity, spin_free, spin_previous,
   * spin and lists of nodes: contacts 0 to node_count - 1. impulse is read, too, and moment where the form
   * has spins: the iterations begin with them. Leave there what the last step left (times the new step over
   * the old one, where it changes), and zero at contacts that are new. The moment acts at the body, its
   * opposite at the counterpart. */
  const ilaw_batch* batch;
  const int32_t* body;        /* per contact the body into which the normal points, from index_base of the
                                 batch on; with body_count b, b entries per contact */
  const int32_t* counterpart; /* per contact the other one; below index_base: a wall */
  ilaw_input arm;             /* 3, with inertia: from the body's centre to the contact [m] */
  ilaw_input counterpart_arm; /* 3, with inertia: from the counterpart's; not read at walls */
  ilaw_input wall_velocity;   /* d, optional: subtracted from the velocity of the contact, its mean over the
                                 step: of a wall; between bodies, of a belt or an imposed slip */
  ilaw_input wall_previous;   /* d, optional: the same of the step before; absent: as wall_velocity */
  ilaw_input wall_spin; /* 3, optional, read where the form has spins: subtracted from the relative spin of
                           the contact, which is the body's less the counterpart's, as wall_velocity is */
  ilaw_input wall_spin_previous; /* 3, optional: of the step before; absent: as wall_spin */
  uint32_t body_count; /* entries of body per contact; 0: 1. Entries below index_base are empty, but the
                          first of body is not */
  uint32_t counterpart_count; /* the same of counterpart */
  /* Optional, per contact body_count values w_i, or body_count d x d matrices by rows (component stride over
   * all of them), for nodes with axes of their own; absent: 1 for one body. weight_size: 0 or 1: values,
   * d * d: matrices. */
  ilaw_input body_weight;
  ilaw_input counterpart_weight;
  uint32_t weight_size;
  uint32_t reserved; /* 0 */
} ilaw_contacts;

/* Callbacks of the host, in exchange. */
typedef void(ILAW_CALL* ilaw_sum_bodies_function)(void* context, double* values, int64_t components);
typedef void(ILAW_CALL* ilaw_reduce_function)(void* context, double* values, int64_t count);

/* How ranks agree. All of them call ilaw_coupled_solve together, those without contacts as well. A contact
 * that crosses the border of two ranks is given on one of them. */
typedef struct ilaw_exchange {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  void* context;
  /* values has `components` doubles per body: the sums over the contacts of this rank. Makes them the sums
   * over all copies of the body on all ranks, with the same bits at each copy. */
  ilaw_sum_bodies_function sum_bodies;
  /* The largest over all ranks, the sum over all ranks, of each of `count` values; the same on all. */
  ilaw_reduce_function largest;
  ilaw_reduce_function sum;
} ilaw_exchange;

/* A part of the solver's work: number `thread` of `count`. */
typedef void(ILAW_CALL* ilaw_work_function)(void* work, uint32_t thread, uint32_t count);
typedef void(ILAW_CALL* ilaw_run_function)(void* context, uint32_t threads, ilaw_work_function part,
                                           void* work);

/* Threads of the host, such as those of OpenMP, so that those of the solver do not compete with them. run
 * calls part(work, t, count) for t = 0 .. count - 1, all at the same time, since they wait for each other: 0
 * on the caller's thread, each other on a thread of its own. It returns when all of them have. count is at
 * most `threads`, and 1 is right where the host has no other thread free. Called several times in a solve. */
typedef struct ilaw_threads {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  void* context;
  ilaw_run_function run;
} ilaw_threads;

/* All zero asks for what the comments say. */
typedef struct ilaw_coupled_options {
  uint32_t struct_size;
  uint32_t most_sweeps;          /* largest number of iterations; 0: 1000. From 10 to 100: up to 20 Newton
                                    steps more for coupled sets of at most 32 contacts that are off by 1e-3 */
  double tolerance;              /* of the residual; 0: 1e-10. A gap that this part of the speed of its bodies
                                    closes in a step counts as closed */
  const ilaw_exchange* exchange; /* null: one process */
  double speed;                  /* the residual is relative to no smaller velocity; 0: only to that at which
                                    the tolerance is the rounding of the largest speed of the bodies */
  double rounding;               /* velocity [m/s] to which contacts are known, such as the rounding of a gap
                                    over the step; 0: none. A residual below it that iterations no longer lower
                                    counts as solved: redundant contacts, whose gaps differ by rounding, have
                                    no better solution */
  uint32_t threads;              /* number of threads, at most 256, where some 6000 contacts and more are
                                    coupled; the same bits for any number. 0, 1: the caller's alone. The
                                    others belong to the solver, and sleep between its calls */
  uint32_t reserved;             /* 0 */
  const ilaw_threads* pool;      /* that run them; null: the solver's own */
} ilaw_coupled_options;

/* Method that made the last iteration of the island that took most of them. */
enum {
  ILAW_METHOD_GAUSS_SEIDEL = 0,
  ILAW_METHOD_CONJUGATE = 1,        /* Gauss-Seidel with nonlinear conjugate directions */
  ILAW_METHOD_ANDERSON = 2,         /* Gauss-Seidel with Anderson's acceleration */
  ILAW_METHOD_DOUGLAS_RACHFORD = 3, /* splitting, with a sparse factor */
  ILAW_METHOD_NEWTON = 4,
};

/* Findings of a solve. The caller sets struct_size. */
typedef struct ilaw_coupled_report {
  uint32_t struct_size;
  uint32_t sweeps;                  /* iterations */
  double residual;                  /* largest |H dr| over the contacts in the last iteration, or the rounding
                                       of impulses above 1e4 first_speed, relative to first_speed. A spin counts
                                       as a velocity, times the root of h/j: the means of H and J */
  double work;                      /* of all impulses and moments, with the final velocities [J] */
  double energy[ILAW_ENERGY_COUNT]; /* sums over contacts, 0 where a batch has no energy array */
  int64_t bad_count;                /* contacts with bad input */
  int64_t bad_group;                /* of the first of them, or of the group that was refused; -1: none */
  int64_t bad_contact;              /* the first of them; -1: none */
  const char* reason;               /* text until the solver's next call, null when none */
  double stable_velocity_step; /* as of ilaw_report, with the masses divided among the contacts that push;
                                  infinity: no limit */
  uint32_t method;             /* ILAW_METHOD_* */
  uint32_t stalled;            /* 1: the residual is above the tolerance, and the last half of the
                                  iterations over an island did not lower it by a tenth */
  int64_t worst_group;         /* contact with the largest residual, where that is above the tolerance;
                                  -1: none */
  int64_t worst_contact;
  /* Ids of the law of the worst contact and of another law at its bodies (or the same law) that push against
   * each other without end: each iteration adds the same impulses, along normals or in bonds, and moves
   * nothing, until they make 4e7 times the velocities of the problem. Laws that contradict each other do so.
   * Null: no such pair. */
  const char* law;
  const char* other_law;
  double speed;       /* largest velocity of a contact, before or by an impulse, in the last iteration */
  double first_speed; /* largest velocity that the problem brings to the contacts of the worst island: without
                         impulses, before the step, of walls, or that of the options. residual * first_speed
                         is a velocity */
  double energy_error; /* sum over contacts of |r.s|/2, where velocities are off by s from those of the last
                          evaluation: the largest difference of `work` and energies [J]; 0 where the
                          residual is within the tolerance and no batch has energies or amounts */
  int64_t island_contacts; /* where the residual is above the tolerance: contacts that are coupled with the
                              worst one, and the ratio of the largest to the smallest mass of their bodies */
  double mass_ratio;
  const char* message; /* what is not solved, as a sentence that names contact and laws, until the solver's
                          next call; null: the residual is within the tolerance, or the rounding of impulses
                          and below 1e-8, or within that of the options */
} ilaw_coupled_report;

/* The work arrays of solves, which grow as needed and are kept. */
typedef struct ilaw_coupled ilaw_coupled;

/* Null: out of memory. */
ilaw_coupled* ILAW_CALL ilaw_coupled_create(void);
void ILAW_CALL ilaw_coupled_destroy(ilaw_coupled* solver); /* null is allowed */

/* Solves a step: impulses, states, status and energies of all contacts, velocities and impulses of the
 * bodies. State, impulse, status, energies and amounts belong to the last evaluation of a contact. Energies
 * and `work` close a balance except for energy_error. options and report may be null. work, energy and counts
 * of the report are those of this rank's contacts. Returns ILAW_OK; ILAW_BAD_NODES, when some contacts had
 * bad input and no impulse; or a negative code with nothing written, on all ranks if on one. Reaching
 * most_sweeps is no error: look at the residual. */
ilaw_result ILAW_CALL ilaw_coupled_solve(ilaw_coupled* solver, const ilaw_bodies* bodies,
                                         const ilaw_contacts* const* groups, int64_t group_count,
                                         const ilaw_coupled_options* options, ilaw_coupled_report* report);

/* Size of each struct in its first version, the least that is accepted. */
#define ILAW_BODIES_SIZE_1_0 ILAW_SIZE_TO(ilaw_bodies, angular_impulse)
#define ILAW_CONTACTS_SIZE_1_0 ILAW_SIZE_TO(ilaw_contacts, reserved)
#define ILAW_THREADS_SIZE_1_0 ILAW_SIZE_TO(ilaw_threads, run)
#define ILAW_EXCHANGE_SIZE_1_0 ILAW_SIZE_TO(ilaw_exchange, sum)
#define ILAW_COUPLED_OPTIONS_SIZE_1_0 ILAW_SIZE_TO(ilaw_coupled_options, pool)
#define ILAW_COUPLED_REPORT_SIZE_1_0 ILAW_SIZE_TO(ilaw_coupled_report, message)

#if defined(ILAW_BUILDING_SHARED_COUPLED)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* ILAW_COUPLED_H */

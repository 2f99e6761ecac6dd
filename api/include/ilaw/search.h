/* search.h - which points meet which facets of a surface, for hosts whose meshes do not match: for each point
 * the closest facet, with gap, normal and the weights of the facet's nodes, as coupled.h takes them.
 *
 * The order of calls: create once, and in every step ilaw_facets_update with the positions, ilaw_facets_near
 * for the points that may touch, and ilaw_facets_pairs for the pairs of these. A step that finds nobody near
 * costs a pass over the positions, and a host that knows how fast its nodes are may leave the step out
 * (`slack`).
 *
 * Which facet is closest does not depend on earlier calls: of all facets the one at the least distance, and
 * of equal ones the first. Lists of facets that are kept from step to step are used only while they are
 * proven to contain that facet, by the motion of the points relative to the surface. A motion of both as one
 * rigid body counts as none.
 *
 * Units are those of the positions. Structs grow as those of ilaw.h: struct_size first, new members at the
 * end, absent means zero. Calls allocate nothing but in create. Threads: different searches are independent;
 * several threads may call ilaw_facets_pairs of one search at once for different points; results and counts
 * are the same for any number.
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#ifndef ILAW_SEARCH_H
#define ILAW_SEARCH_H

#include <ilaw/ilaw.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(ILAW_BUILDING_SHARED_SEARCH)
#pragma GCC visibility push(default)
#endif

/* Points and surface of a search: read by create, which keeps no pointer. */
typedef struct ilaw_facets_setup {
  uint32_t struct_size;
  uint32_t dimension;    /* 2 or 3 */
  uint32_t corner_count; /* corners per facet: 2 in 2D; 3 or 4 in 3D, where the last corner of a triangle
                            among quadrilaterals is there twice. Seen from the side of the points, corners of
                            a facet in 3D follow each other counterclockwise; in 2D the points are to the
                            right of the way from the first corner to the second */
  int32_t index_base;    /* first value of an index: 0 in C, 1 in Fortran */
  int64_t node_count;    /* nodes that positions are given of */
  int64_t facet_count;   /* at least 1 */
  const int32_t* facets; /* corner_count nodes per facet */
  int64_t point_count;   /* points that may meet the surface */
  const int32_t* points; /* the node that each of them is */
  ilaw_input position;   /* d: position of each node of the model before a run, for the lengths of edges */
} ilaw_facets_setup;

/* Positions of all nodes: position + displacement. The arrays are read during the call alone. */
typedef struct ilaw_facets_positions {
  uint32_t struct_size;
  uint32_t reserved;       /* 0 */
  ilaw_input position;     /* d */
  ilaw_input displacement; /* d, optional: added to position */
} ilaw_facets_positions;

/* The points that may touch soon. The caller sets struct_size and the inputs. */
typedef struct ilaw_facets_nearby {
  uint32_t struct_size;
  uint32_t forced; /* in: 1: anew, although the last list is still complete */
  double reach; /* in: points with gaps up to it must be in the list: thickness, and the distance by which a
                   gap may close in the coming step. At least 0 */
  uint32_t is_new;       /* out: 1: the list differs, or may differ, from that of the call before */
  uint32_t reserved;     /* 0 */
  int64_t count;         /* out: length of the list */
  const int32_t* points; /* out: by number of the point from 0 on, in groups of neighbors; until the next
                            call. All other points have a gap above the horizon */
  double horizon;        /* out: gap up to which points are in the list that was made last */
  double slack; /* out: while the motion of each node from here on, and reach, stay below in sum, the list
                   need not be asked for. 0 where it is not empty */
} ilaw_facets_nearby;

/* Pairs of some points, at the positions of the last update. Null outputs are left out. */
typedef struct ilaw_facets_pairs_of {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  int64_t count;
  const int32_t* points; /* by number from 0 on; null: 0 to count - 1 */
  ilaw_input rim;  /* 1, optional: how far a facet goes on beyond the border of the surface, and how deep
                      behind it a point there still belongs to it. A border is an edge (2D: a corner) of one
                      facet alone. Node stride 0: the same for all */
  int32_t* facet;  /* number of the facet from 0 on; -1: none, where positions are not finite */
  int32_t* place;  /* ILAW_PLACE_* */
  ilaw_output gap; /* 1: distance from the facet along its normal, negative behind it; at a point that is over
                      no facet the distance to the closest one */
  ilaw_output normal;  /* d: unit normal of the facet, where it is closest to the point */
  ilaw_output weights; /* corner_count: of the facet's corners; their sum is 1 */
  ilaw_output
      approach; /* 1: the least relative motion by which the point may come to a gap of 0; 0: behind */
} ilaw_facets_pairs_of;

enum {
  ILAW_PLACE_OVER = 0,   /* the point is over the facet, within the rim beside it, or behind a fold */
  ILAW_PLACE_BESIDE = 1, /* in front of the surface, beside the closest facet by more than rounding */
  ILAW_PLACE_BEYOND = 2, /* beyond the border of the surface */
};

/* Facets near the faces of another body, whose corners are points of the search: for constraints that are
 * integrated over the overlap of two faces. */
typedef struct ilaw_facets_overlaps_of {
  uint32_t struct_size;
  uint32_t corner_count; /* of a face */
  int64_t count;         /* faces */
  const int32_t* points; /* corner_count per face: points by number from 0 on */
  double distance;  /* facets whose bounding box comes closer than this to the face's: all that the face comes
                       closer to are among them */
  int64_t capacity; /* entries in facets */
  int64_t* first;  /* out, count + 1: where the facets of each face begin, and the end. Where the end is above
                      the capacity, facets is not complete */
  int32_t* facets; /* out: in ascending order for each face */
} ilaw_facets_overlaps_of;

/* Counts since create. The caller sets struct_size. */
typedef struct ilaw_facets_counts {
  uint32_t struct_size;
  uint32_t reserved;    /* 0 */
  int64_t updates;      /* calls of ilaw_facets_update */
  int64_t refreshes;    /* lists of near points that were made */
  int64_t refits;       /* times that the tree over the facets followed the surface */
  int64_t pairs;        /* pairs that were sought */
  int64_t facets;       /* facets that were looked at for them: bounding boxes, and projections */
  double shortest_edge; /* of the surface before the run */
  double motion;        /* of points and surface relative to each other, since the list was made */
} ilaw_facets_counts;

typedef struct ilaw_facets ilaw_facets;

/* ILAW_INVALID_ARGUMENT: a null pointer, a count, a node or a dimension out of range; ILAW_OUT_OF_MEMORY.
 * *search is null then. */
ilaw_result ILAW_CALL ilaw_facets_create(const ilaw_facets_setup* setup, ilaw_facets** search);
void ILAW_CALL ilaw_facets_destroy(ilaw_facets* search); /* null is allowed */

/* Takes new positions. Must come first. */
ilaw_result ILAW_CALL ilaw_facets_update(ilaw_facets* search, const ilaw_facets_positions* positions);
ilaw_result ILAW_CALL ilaw_facets_near(ilaw_facets* search, ilaw_facets_nearby* nearby);
ilaw_result ILAW_CALL ilaw_facets_pairs(ilaw_facets* search, const ilaw_facets_pairs_of* pairs);
ilaw_result ILAW_CALL ilaw_facets_overlaps(const ilaw_facets* search,
                                           const ilaw_facets_overlaps_of* overlaps);
ilaw_result ILAW_CALL ilaw_facets_count(const ilaw_facets* search, ilaw_facets_counts* counts);

/* Size of each struct in its first version, the least that is accepted. */
#define ILAW_FACETS_SETUP_SIZE_1_0 ILAW_SIZE_TO(ilaw_facets_setup, position)
#define ILAW_FACETS_POSITIONS_SIZE_1_0 ILAW_SIZE_TO(ilaw_facets_positions, displacement)
#define ILAW_FACETS_NEARBY_SIZE_1_0 ILAW_SIZE_TO(ilaw_facets_nearby, slack)
#define ILAW_FACETS_PAIRS_OF_SIZE_1_0 ILAW_SIZE_TO(ilaw_facets_pairs_of, approach)
#define ILAW_FACETS_OVERLAPS_OF_SIZE_1_0 ILAW_SIZE_TO(ilaw_facets_overlaps_of, facets)
#define ILAW_FACETS_COUNTS_SIZE_1_0 ILAW_SIZE_TO(ilaw_facets_counts, motion)

#if defined(ILAW_BUILDING_SHARED_SEARCH)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* ILAW_SEARCH_H */

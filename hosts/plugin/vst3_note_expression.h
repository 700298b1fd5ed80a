// SPDX-License-Identifier: MIT
// VST3's interfaces INoteExpressionController and INoteExpressionPhysicalUIMapping, which the framework lacks. Names of
// functions follow those of VST3.
#pragma once

#include "src/travesty/base.h"

#include "src/travesty/align_push.h"

struct v3_note_expression_type_info {
  enum { kIsBipolar = 1 };  ///< flags

  uint32_t type_id;
  v3_str_128 title, short_title, units;
  int32_t unit_id;  ///< -1: none
  double initial, min, max;
  int32_t step_count;  ///< 0: continuous
  uint32_t parameter;  ///< that goes with it, where flags say so
  int32_t flags;
};

struct v3_physical_ui_map {
  uint32_t movement;    ///< 0 along the keys, 1 across them, 2 pressure
  uint32_t expression;  ///< the type_id that it moves, or all bits
};

struct v3_physical_ui_map_list {
  uint32_t count;
  v3_physical_ui_map* maps;
};

#include "src/travesty/align_pop.h"

struct v3_note_expression_controller {
  int32_t(V3_API* get_note_expression_count)(void* self, int32_t bus, int16_t channel);
  v3_result(V3_API* get_note_expression_info)(void* self, int32_t bus, int16_t channel, int32_t number,
                                              v3_note_expression_type_info* info);
  v3_result(V3_API* get_note_expression_string_by_value)(void* self, int32_t bus, int16_t channel, uint32_t type_id,
                                                         double part, v3_str_128 text);
  v3_result(V3_API* get_note_expression_value_by_string)(void* self, int32_t bus, int16_t channel, uint32_t type_id,
                                                         const int16_t* text, double* part);
};
static constexpr const v3_tuid v3_note_expression_controller_iid =
    V3_ID(0xB7F8F859, 0x41234872, 0x91169581, 0x4F3721A3);

struct v3_note_expression_physical {
  v3_result(V3_API* get_physical_ui_mapping)(void* self, int32_t bus, int16_t channel, v3_physical_ui_map_list* list);
};
static constexpr const v3_tuid v3_note_expression_physical_iid =
    V3_ID(0xB03078FF, 0x94D24AC8, 0x90CCD303, 0xD4133324);

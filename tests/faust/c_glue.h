/* SPDX-License-Identifier: MIT
   What Faust's generated C expects. Zones have no type here: it depends on the precision. */
#ifndef CONTACTSPLINE_TESTS_C_GLUE_H
#define CONTACTSPLINE_TESTS_C_GLUE_H

typedef struct {
  void* metaInterface;
  void (*declare)(void* meta, const char* key, const char* value);
} MetaGlue;

typedef struct {
  void* uiInterface;
  void (*openVerticalBox)(void* ui, const char* label);
  void (*closeBox)(void* ui);
  void (*declare)(void* ui, void* zone, const char* key, const char* value);
  void (*addButton)(void* ui, const char* label, void* zone);
  void (*addHorizontalSlider)(void* ui, const char* label, void* zone, double init, double min, double max,
                              double step);
} UIGlue;

#ifndef __cplusplus
static inline int min(int a, int b) { return a < b ? a : b; }
static inline int max(int a, int b) { return a > b ? a : b; }
#endif

#endif

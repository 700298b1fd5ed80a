/* SPDX-License-Identifier: MIT */
/* Contact Spline in C99: instruments by name or from a file's text, played in blocks. All values are in SI units.
 * An instrument is used by one thread at a time. What is said to be safe for audio neither allocates nor locks; there,
 * a null instrument, an index that is too large and a value that is not a number do nothing. */
#ifndef CONTACTSPLINE_H
#define CONTACTSPLINE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct contactspline_instrument contactspline_instrument;

/** The numbers that a model computes in. Either kind of process function plays either precision. */
enum contactspline_precision { CONTACTSPLINE_DOUBLE = 0, CONTACTSPLINE_FLOAT = 1 };

/** What can be set while an instrument plays. Text and lists live as long as the instrument. */
typedef struct contactspline_parameter {
  const char* name;          /**< lower-case identifier that ends with the unit: hammer_mass_kg */
  const char* unit;          /**< of SI; empty for a number */
  double min, max;           /**< values that are allowed; others are moved into the range */
  double slider_min;         /**< where it is played, within the range */
  double slider_max;
  double initial;
  int is_logarithmic;        /**< 1: a slider moves in equal ratios */
  int acts_at_next_note;     /**< 0: at once */
  double glide_s;            /**< time constant with which hosts should move it; 0: at once */
} contactspline_parameter;

typedef struct contactspline_output {
  const char* name;          /**< lower-case identifier that ends with the unit: bridge_force_n */
  const char* unit;          /**< of SI */
  double full_scale;         /**< the value that hosts play as 1 */
} contactspline_output;

enum contactspline_event_kind { CONTACTSPLINE_STRIKE = 0, CONTACTSPLINE_PLUCK = 1 };

/** What an instrument is played by, beside keys: contactspline_strike() or contactspline_pluck(). */
typedef struct contactspline_event {
  const char* name;          /**< lower-case identifier: strike_hammer */
  int kind;                  /**< contactspline_event_kind */
  size_t number;             /**< among the events of its kind */
  size_t parameter;          /**< index of the parameter that holds its usual speed or force */
} contactspline_event;

/** Version of the library: "0.2.0". */
const char* contactspline_version(void);

/** Why the last function of this thread that failed did so, as one line: file, key, what is wrong, what is allowed.
 * Empty before the first failure; stays until the next one. */
const char* contactspline_last_error(void);

/** Names of the instruments that ship; ends with a null pointer. */
const char* const* contactspline_names(void);

/** An instrument at rest, by its name or by the path of an instrument file. Rate: 1000 to 768000 Hz.
 * Returns null where it fails. Allocates. */
contactspline_instrument* contactspline_create(const char* name, double sample_rate_hz, int precision);

/** The same from the text of an instrument file (docs/reference/instruments.md), which ends with a 0. `file` stands in
 * messages; files that the text names are read from its folder. */
contactspline_instrument* contactspline_create_from_json(const char* text, const char* file, double sample_rate_hz,
                                                         int precision);

/** Ends an instrument; a null pointer does nothing. */
void contactspline_destroy(contactspline_instrument* instrument);

/** Identifier, one line, and SPDX identifier of its licence; null for a null instrument. */
const char* contactspline_name(const contactspline_instrument* instrument);
const char* contactspline_description(const contactspline_instrument* instrument);
const char* contactspline_license(const contactspline_instrument* instrument);

/** Lists. Safe for audio. An index that is too large gives a null pointer. */
size_t contactspline_parameter_count(const contactspline_instrument* instrument);
const contactspline_parameter* contactspline_parameter_at(const contactspline_instrument* instrument, size_t index);
size_t contactspline_output_count(const contactspline_instrument* instrument);
const contactspline_output* contactspline_output_at(const contactspline_instrument* instrument, size_t index);
size_t contactspline_event_count(const contactspline_instrument* instrument);
const contactspline_event* contactspline_event_at(const contactspline_instrument* instrument, size_t index);
size_t contactspline_preset_count(const contactspline_instrument* instrument);
const char* contactspline_preset_name(const contactspline_instrument* instrument, size_t index);

/** Parameters. Safe for audio. The value of an index that is too large is not a number. */
void contactspline_set(contactspline_instrument* instrument, size_t parameter, double value);
double contactspline_get(const contactspline_instrument* instrument, size_t parameter);
void contactspline_load_preset(contactspline_instrument* instrument, size_t preset);

/** A key of MIDI goes down, with a velocity from 0 to 1, and up. Safe for audio. Keys that it lacks do nothing. */
void contactspline_note_on(contactspline_instrument* instrument, int key, double velocity);
void contactspline_note_off(contactspline_instrument* instrument, int key);

/** Events by their number among those of their kind. Safe for audio. Speed in m/s; 0 lifts the damper without a blow,
 * which release lowers. Force in N, reached within rise_s. */
void contactspline_strike(contactspline_instrument* instrument, size_t number, double speed_m_per_s);
void contactspline_release(contactspline_instrument* instrument, size_t number);
void contactspline_pluck(contactspline_instrument* instrument, size_t number, double force_n, double rise_s);

/** Advances `samples` samples. outputs: one array for each output of the list, null for those that nobody wants, or
 * null for all; force: the sum of the contact forces [N], or null. Safe for audio. */
void contactspline_process(contactspline_instrument* instrument, float* const* outputs, float* force, size_t samples);
void contactspline_process_double(contactspline_instrument* instrument, double* const* outputs, double* force,
                                  size_t samples);

/** Brings it to rest; parameters stay. Safe for audio. */
void contactspline_reset(contactspline_instrument* instrument);

/** Energy that is stored [J], and whether nothing moves on its own and the energy is below a limit. Safe for audio. */
double contactspline_energy(const contactspline_instrument* instrument);
int contactspline_is_silent(const contactspline_instrument* instrument, double limit_j);

#ifdef __cplusplus
}
#endif

#endif

/* An image sensor behind a lens: what it is, and the stages from radiance to digital numbers. */
#ifndef PL_SENSOR_SENSOR_H
#define PL_SENSOR_SENSOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "sensor/flare.h"
#include "sensor/shading.h"

/* Which colour the pixel (0, 0), its right neighbour, and the two below them see. */
typedef enum pl_mosaic {
  PL_MOSAIC_MONO, /* no filters: a pixel gathers all three bands */
  PL_MOSAIC_RGGB,
  PL_MOSAIC_BGGR,
  PL_MOSAIC_GRBG,
  PL_MOSAIC_GBRG,
  PL_MOSAIC_COUNT
} pl_mosaic;

typedef enum pl_psf_core {
  PL_PSF_POINT, /* none: all in its pixel */
  PL_PSF_GAUSS,
  PL_PSF_AIRY,     /* diffraction by a round aperture, at the mean wavelength of each band */
  PL_PSF_MEASURED, /* an image of it */
  PL_PSF_CORES
} pl_psf_core;

/* Point-spread function: a core, and wings of a power law (scatter in the lens: glare). */
typedef struct pl_psf {
  pl_psf_core core;
  double sigma_px;       /* of the Gaussian, > 0 */
  double wings;          /* part of the light that is in the wings, 0..1 */
  double wing_radius_px; /* where they turn down, > 0 */
  double wing_beta;      /* fall as r^(-2 beta) far out, > 1 */
  /* Measured: parts of the light that pixels get, of light in the middle of the pixel
   * (kernel_width / 2, kernel_height / 2); row-major, sum 1. */
  const double *kernel; /* borrowed */
  int kernel_width, kernel_height;
} pl_psf;

/* The camera chooses its exposure time by what it sees. */
enum { PL_AUTO_TIMES = 64, PL_AUTO_GAINS = 16 };
typedef struct pl_auto_time {
  bool on;
  bool mean;                     /* by the mean of the window's pixels, else ... */
  double percentile;             /* ... by this percentile of those that are lit, 0..100: it ... */
  double key;                    /* ... is brought to this fraction of white, linear */
  double window[4];              /* x0, y0, x1, y1 of the pixels that count, 0..1 over the image */
  double saturated;              /* part of the window's pixels that may be more than white, 0..1 */
  double min_s, max_s;           /* the shortest and longest time */
  double step_s;                 /* times are whole multiples of this, rounded down; 0: any */
  int time_count;                /* 0: any time */
  double times_s[PL_AUTO_TIMES]; /* the times there are, rising */
  int gain_count;                /* 0: one gain */
  double gains[PL_AUTO_GAINS];   /* factors on digital numbers an electron, rising, > 0 */
} pl_auto_time;

typedef enum pl_chroma { PL_CHROMA_444, PL_CHROMA_422, PL_CHROMA_420, PL_CHROMAS } pl_chroma;

/* JPEG, of the picture. */
typedef struct pl_compression {
  int quality;      /* 1..100 as of libjpeg; 0: none */
  pl_chroma chroma; /* how many pixels share a colour: 1, 2 in a row, 2 x 2 */
} pl_compression;

/* What the whole sensor sees through a filter: by red, green and blue of the light, as the fields
 * of the same names; its quantum efficiency is in the shares. */
typedef struct pl_sensor_plane {
  double band_share[3], wavelength_m[3];
} pl_sensor_plane;

/* Where it has planes, band_share and wavelength_m are to be those of the one that fills first, and
 * its wavelengths at least as long as those of the others. */
typedef struct pl_sensor {
  /* lens */
  double f_number;     /* E = pi L T / (4 N^2) on the axis, by the sine condition ... */
  bool plane_pupil;    /* ... or E = pi L T / (4 N^2 + 1), through a flat opening */
  double transmission; /* 0..1 */
  pl_shading shading;  /* vignetting */
  pl_psf psf;
  pl_flare flare;
  /* pixels */
  double pixel_m;
  pl_mosaic mosaic;
  double quantum_efficiency[3]; /* red, green, blue: electrons a photon, 0..1 */
  double band_share[3];         /* part of the sun's irradiance that lies in the band */
  double wavelength_m[3];       /* mean of the band, by energy: electrons are exact */
  bool mixed;                   /* whether filters see several colours; then ... */
  double mix[3][3]; /* ... by band, parts of its charge by red, green and blue, of white */
  const pl_sensor_plane *planes; /* borrowed: of PL_MOSAIC_MONO through filters in turn ... */
  size_t plane_count;            /* ... an image of each; 0: none */
  uint64_t serial;               /* which unit of its kind: keys what is fixed in it */
  /* exposure */
  double exposure_s;
  pl_auto_time auto_time;
  /* charge */
  double prnu;            /* relative standard deviation of the pixels' response */
  double dark_current;    /* electrons a second and pixel */
  double dark_nonuniform; /* relative standard deviation of the dark current between pixels */
  double hot_pixels;      /* part of the pixels, 0..1 */
  double hot_current;     /* their dark current, electrons a second */
  double dead_pixels;     /* part of the pixels, 0..1 */
  double shift_s;         /* of a row, in light (frame transfer); 0: no smear */
  double full_well;       /* electrons */
  double drain;           /* part of a full pixel's excess that is drained off; 1: no blooming */
  double reset_s;         /* between a pixel's reset and its sample; 0: no black sun */
  /* particles */
  double ray_flux;            /* rays a square metre and second */
  double ray_electrons_per_m; /* freed along a track */
  double ray_depth_m;         /* of the layer in which charge is gathered */
  /* reading out */
  double read_noise;     /* electrons, standard deviation */
  double column_noise;   /* likewise of an offset that a column keeps in all frames */
  double column_flicker; /* of one that a column has anew in each frame */
  double row_noise;      /* of one that a row has anew in each frame */
  double gain;           /* electrons a digital number */
  double black_level;    /* digital numbers */
  int bits;              /* 1..16 */
  pl_compression compression;
} pl_sensor;

/* PL_E_RANGE naming what is outside of its range. */
pl_status pl_sensor_check(const pl_sensor *sensor);

/* Electrons that a radiance of 1 W m-2 sr-1 frees in a pixel under the filter of band `band`, on
 * the axis, in the exposure time. EMVA 1288 release 4, section 2, with the camera equation. */
double pl_sensor_response(const pl_sensor *sensor, int band);
/* Of a white radiance in the pixels that it fills first: the largest response of a band, or without
 * filters the sum of all. */
double pl_sensor_response_white(const pl_sensor *sensor);
/* Electrons at which the image is white: the full well, or less where the digits end before. */
double pl_sensor_white_electrons(const pl_sensor *sensor);
/* The sensor that makes one of the planes. */
pl_sensor pl_sensor_of_plane(const pl_sensor *sensor, size_t plane);
/* What the picture multiplies a band's charge by, so that a white sunlit surface is grey; at least
 * 1. Without filters, and for a band without a response, 1. */
double pl_sensor_balance(const pl_sensor *sensor, int band);
/* Sum of the standard deviations of all that is added in reading a pixel, electrons. */
double pl_sensor_read_deviation(const pl_sensor *sensor);
/* The band that a pixel sees, 0..2; for PL_MOSAIC_MONO always 1. */
int pl_sensor_band(pl_mosaic mosaic, int x, int y);

#endif

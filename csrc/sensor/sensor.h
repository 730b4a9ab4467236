/* An image sensor behind a lens: its parameters, and quantities derived from them. */
#ifndef PL_SENSOR_SENSOR_H
#define PL_SENSOR_SENSOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "sensor/flare.h"
#include "sensor/shading.h"

/* Colour filter array: the filters of the pixel (0, 0), its right neighbour, and the two pixels
 * below them. */
typedef enum pl_mosaic {
  PL_MOSAIC_MONO, /* no filters: a pixel integrates all three bands */
  PL_MOSAIC_RGGB,
  PL_MOSAIC_BGGR,
  PL_MOSAIC_GRBG,
  PL_MOSAIC_GBRG,
  PL_MOSAIC_COUNT
} pl_mosaic;

typedef enum pl_psf_core {
  PL_PSF_POINT, /* none: all energy in one pixel */
  PL_PSF_GAUSS,
  PL_PSF_AIRY,     /* diffraction by a circular aperture, at the mean wavelength of each band */
  PL_PSF_MEASURED, /* given as an image */
  PL_PSF_CORES
} pl_psf_core;

/* Point-spread function: a core, and power-law wings (light scattered in the lens: glare). */
typedef struct pl_psf {
  pl_psf_core core;
  double sigma_px;       /* standard deviation of the Gaussian, > 0 */
  double wings;          /* fraction of the light in the wings, 0..1 */
  double wing_radius_px; /* radius at which the wings begin to fall, > 0 */
  double wing_beta;      /* the wings fall as r^(-2 beta) far out, > 1 */
  /* Measured core: fractions of the light that pixels receive from a source at the centre of the
   * pixel (kernel_width / 2, kernel_height / 2); row-major, sum 1. */
  const double *kernel; /* borrowed */
  int kernel_width, kernel_height;
} pl_psf;

/* Automatic exposure: the camera chooses its exposure time from a preview image. */
enum { PL_AUTO_TIMES = 64, PL_AUTO_GAINS = 16 };
typedef struct pl_auto_time {
  bool on;
  bool mean;           /* meters the mean of the window's pixels, otherwise ... */
  double percentile;   /* ... this percentile of the lit pixels, 0..100; the metered value ... */
  double key;          /* ... is exposed to this fraction of white, linear */
  double window[4];    /* x0, y0, x1, y1 of the metered window, 0..1 over the image */
  double saturated;    /* fraction of the window's pixels that may exceed white, 0..1 */
  double min_s, max_s; /* shortest and longest exposure time */
  double step_s;       /* times are integer multiples of this, rounded down; 0: any */
  int time_count;      /* 0: any time */
  double times_s[PL_AUTO_TIMES]; /* the available times, increasing */
  int gain_count;                /* 0: one gain */
  double gains[PL_AUTO_GAINS];   /* factors on digital numbers per electron, increasing, > 0 */
} pl_auto_time;

typedef enum pl_chroma { PL_CHROMA_444, PL_CHROMA_422, PL_CHROMA_420, PL_CHROMAS } pl_chroma;

/* JPEG compression of the 8-bit image. */
typedef struct pl_compression {
  int quality;      /* 1..100 as in libjpeg; 0: no compression */
  pl_chroma chroma; /* pixels that share a colour sample: 1, 2 in a row, or 2 x 2 */
} pl_compression;

/* One plane: the whole sensor behind one filter, by red, green and blue of the light, as the fields
 * of pl_sensor with the same names. The quantum efficiency is included in band_share. */
typedef struct pl_sensor_plane {
  double band_share[3], wavelength_m[3];
} pl_sensor_plane;

/* If a sensor has planes, band_share and wavelength_m must be those of the plane that saturates
 * first, and its wavelengths must be at least as long as those of the other planes. */
typedef struct pl_sensor {
  /* lens */
  double f_number;     /* E = pi L T / (4 N^2) on the axis, by the sine condition ... */
  bool plane_pupil;    /* ... or E = pi L T / (4 N^2 + 1), through a flat aperture */
  double transmission; /* 0..1 */
  pl_shading shading;  /* vignetting */
  pl_psf psf;
  pl_flare flare;
  /* pixels */
  double pixel_m;
  pl_mosaic mosaic;
  double quantum_efficiency[3]; /* red, green, blue: electrons per photon, 0..1 */
  double band_share[3];         /* fraction of the solar irradiance in the band */
  double wavelength_m[3]; /* energy-weighted mean of the band, so that electron counts are exact */
  bool mixed;             /* true if filters respond to several colours; then ... */
  double mix[3][3];       /* ... by band, fractions of its charge from red, green, blue of white */
  const pl_sensor_plane *planes; /* borrowed: filters used in turn with PL_MOSAIC_MONO ... */
  size_t plane_count;            /* ... one image per filter; 0: none */
  uint64_t serial;               /* unit of its kind: random key of all fixed patterns */
  /* exposure */
  double exposure_s;
  pl_auto_time auto_time;
  /* charge */
  double prnu;            /* relative standard deviation of the pixels' response */
  double dark_current;    /* electrons per second and pixel */
  double dark_nonuniform; /* relative standard deviation of the dark current between pixels */
  double hot_pixels;      /* fraction of the pixels, 0..1 */
  double hot_current;     /* their dark current, electrons per second */
  double dead_pixels;     /* fraction of the pixels, 0..1 */
  double shift_s;         /* time of one row shift, exposed (frame transfer); 0: no smear */
  double full_well;       /* electrons */
  double drain;   /* fraction of a full pixel's excess charge that is drained; 1: no blooming */
  double reset_s; /* time from a pixel's reset to the reset sample; 0: no black sun */
  /* particles */
  double ray_flux;            /* rays per square metre and second */
  double ray_electrons_per_m; /* electrons freed per metre of track */
  double ray_depth_m;         /* of the layer that collects charge */
  /* readout */
  double read_noise;     /* standard deviation, electrons */
  double column_noise;   /* standard deviation of the fixed column offsets, electrons */
  double column_flicker; /* of the column offsets that change in each frame */
  double row_noise;      /* of the row offsets that change in each frame */
  double gain;           /* electrons per digital number */
  double black_level;    /* digital numbers */
  int bits;              /* 1..16 */
  pl_compression compression;
} pl_sensor;

/* Fails with PL_E_RANGE and names the value that is out of range. */
pl_status pl_sensor_check(const pl_sensor *sensor);

/* Electrons that a radiance of 1 W m-2 sr-1 generates during the exposure in a pixel on the axis
 * with the filter of band `band`. EMVA 1288 release 4, section 2, with the camera equation. */
double pl_sensor_response(const pl_sensor *sensor, int band);
/* Response to white radiance of the most sensitive pixels: the largest response of any band, or
 * without filters the sum of all bands. */
double pl_sensor_response_white(const pl_sensor *sensor);
/* Charge at which the image is white, electrons: the full well, or less if the digital range ends
 * earlier. */
double pl_sensor_white_electrons(const pl_sensor *sensor);
/* Radiance at which the most sensitive pixels are full, W m-2 sr-1; infinite for an exposure of 0.
 */
double pl_sensor_full_radiance(const pl_sensor *sensor);
/* The sensor as used for one of the planes. */
pl_sensor pl_sensor_of_plane(const pl_sensor *sensor, size_t plane);
/* White-balance factor of a band, which makes a sunlit white surface grey; at least 1. Without
 * filters, and for a band without a response, 1. */
double pl_sensor_balance(const pl_sensor *sensor, int band);
/* Sum of the standard deviations of all noise added in readout, electrons. */
double pl_sensor_read_deviation(const pl_sensor *sensor);
/* The band of a pixel's filter, 0..2; always 1 for PL_MOSAIC_MONO. */
int pl_sensor_band(pl_mosaic mosaic, int x, int y);

#endif

/* families.c - the table of modifier types: which family each belongs to
 *
 * A new material is a row here, a row in scene/check.c (its arguments), in
 * scene/reach.c what these name, and a file of its own; see trace/material.h. */
#include "config.h"

#include "trace/asks.h"
#include "light/direct/emitter.h"
#include "pattern/effect.h"
#include "pattern/func.h"
#include "pattern/spectral.h"
#include "pattern/table.h"
#include "pattern/text.h"
#include "shade/gloss/aniso.h"
#include "shade/antimatter.h"
#include "shade/gloss/ashik.h"
#include "shade/gloss/brdf.h"
#include "shade/dielectric.h"
#include "shade/glass.h"
#include "shade/mirror.h"
#include "shade/mist.h"
#include "shade/gloss/normal.h"
#include "shade/prism.h"
#include "shade/gloss/scatter.h"
#include "shade/gloss/wgmd.h"

static const struct rad_shader table[] = {
    { RAD_PLASTIC, RAD_MAT_OPAQUE, rad_normal_prepare, rad_normal_shade },
    { RAD_METAL, RAD_MAT_OPAQUE, rad_normal_prepare, rad_normal_shade },
    { RAD_TRANS, RAD_MAT_TRANSPARENT, rad_normal_prepare, rad_normal_shade },
    { RAD_PLASTIC2, RAD_MAT_OPAQUE, rad_aniso_prepare, rad_aniso_shade },
    { RAD_METAL2, RAD_MAT_OPAQUE, rad_aniso_prepare, rad_aniso_shade },
    { RAD_TRANS2, RAD_MAT_TRANSPARENT, rad_aniso_prepare, rad_aniso_shade },
    { RAD_ASHIK2, RAD_MAT_OPAQUE, rad_ashik_prepare, rad_ashik_shade },
    { RAD_PLASFUNC, RAD_MAT_OPAQUE, rad_brdf_prepare, rad_brdf_shade },
    { RAD_METFUNC, RAD_MAT_OPAQUE, rad_brdf_prepare, rad_brdf_shade },
    { RAD_TRANSFUNC, 0, rad_brdf_prepare, rad_brdf_shade },
    { RAD_PLASDATA, RAD_MAT_OPAQUE, rad_brdf_prepare, rad_brdf_shade },
    { RAD_METDATA, RAD_MAT_OPAQUE, rad_brdf_prepare, rad_brdf_shade },
    { RAD_TRANSDATA, 0, rad_brdf_prepare, rad_brdf_shade },
    { RAD_BRTDFUNC, 0, rad_brdf_prepare, rad_brtd_shade },
    { RAD_GLASS, RAD_MAT_TRANSPARENT | RAD_MAT_PASSED, rad_glass_prepare,
      rad_glass_shade },
    { RAD_DIELECTRIC, RAD_MAT_TRANSPARENT, rad_dielectric_prepare,
      rad_dielectric_shade },
    { RAD_INTERFACE, RAD_MAT_TRANSPARENT, rad_dielectric_prepare,
      rad_dielectric_shade },
    { RAD_LIGHT, RAD_MAT_EMITS | RAD_MAT_OPAQUE, rad_emitter_prepare,
      rad_emitter_shade },
    { RAD_ILLUM, RAD_MAT_EMITS, rad_emitter_prepare, rad_emitter_shade },
    { RAD_GLOW, RAD_MAT_EMITS | RAD_MAT_OPAQUE, rad_emitter_prepare,
      rad_emitter_shade },
    { RAD_SPOTLIGHT, RAD_MAT_EMITS | RAD_MAT_OPAQUE, rad_emitter_prepare,
      rad_emitter_shade },
    { RAD_MIRROR, RAD_MAT_OPAQUE, rad_mirror_prepare, rad_mirror_shade },
    { RAD_WGMDFUNC, 0, rad_wgmd_prepare, rad_wgmd_shade },
    { RAD_PRISM1, RAD_MAT_OPAQUE, rad_prism_prepare, rad_prism_shade },
    { RAD_PRISM2, RAD_MAT_OPAQUE, rad_prism_prepare, rad_prism_shade },
    { RAD_MIST, RAD_MAT_TRANSPARENT | RAD_MAT_PASSED, rad_mist_prepare,
      rad_mist_shade },
    { RAD_ANTIMATTER, RAD_MAT_CUTS | RAD_MAT_PASSED, rad_antimatter_prepare,
      rad_antimatter_shade },
    { RAD_BRIGHTTEXT, RAD_MAT_PATTERN, rad_text_prepare, rad_text_shade },
    { RAD_COLORTEXT, RAD_MAT_PATTERN, rad_text_prepare, rad_text_shade },
    { RAD_BRIGHTFUNC, RAD_MAT_PATTERN, rad_func_prepare, rad_effect_brighten },
    { RAD_COLORFUNC, RAD_MAT_PATTERN, rad_func_prepare, rad_effect_colour },
    { RAD_TEXFUNC, RAD_MAT_PATTERN, rad_func_prepare, rad_effect_perturb },
    { RAD_MIXFUNC, RAD_MAT_MIXTURE, rad_func_prepare, rad_effect_mix },
    { RAD_BRIGHTDATA, RAD_MAT_PATTERN, rad_table_prepare, rad_effect_brighten },
    { RAD_COLORDATA, RAD_MAT_PATTERN, rad_table_prepare, rad_effect_colour },
    { RAD_COLORPICT, RAD_MAT_PATTERN, rad_table_prepare, rad_effect_colour },
    { RAD_SPECTRUM, RAD_MAT_PATTERN, rad_spectral_prepare, rad_effect_colour },
    { RAD_SPECFILE, RAD_MAT_PATTERN, rad_spectral_prepare, rad_effect_colour },
    { RAD_SPECFUNC, RAD_MAT_PATTERN, rad_spectral_prepare, rad_effect_colour },
    { RAD_SPECDATA, RAD_MAT_PATTERN, rad_spectral_prepare, rad_effect_colour },
    { RAD_SPECPICT, RAD_MAT_PATTERN, rad_spectral_prepare, rad_effect_colour },
    { RAD_TEXDATA, RAD_MAT_PATTERN, rad_table_prepare, rad_effect_perturb },
    { RAD_MIXDATA, RAD_MAT_MIXTURE, rad_table_prepare, rad_effect_mix },
    { RAD_MIXPICT, RAD_MAT_MIXTURE, rad_table_prepare, rad_effect_mix },
    { RAD_BSDF, 0, rad_scatter_prepare, rad_scatter_shade },
    { RAD_ABSDF, RAD_MAT_TRANSPARENT, rad_scatter_prepare, rad_scatter_shade },
    { RAD_MIXTEXT, RAD_MAT_MIXTURE, rad_text_prepare, rad_text_mix },
};

const struct rad_shader *
rad_families_shader(enum rad_otype type)
{
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        if (table[i].type == type)
            return &table[i];
    return NULL;
}

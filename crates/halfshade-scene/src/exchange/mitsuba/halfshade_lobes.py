"""Cosine lobes beside a diffuse part, as a BSDF of Mitsuba 3; importing this file registers it as `halfshade_lobes`.

    phong           specular max(r.v, 0)^exponent                                              without any cosine
    modified-phong  specular (exponent + 2)/(2 pi) max(r.v, 0)^exponent max(n.v, 0)
    lafortune       sum of scale max(v M o, 0)^exponent max(n.v, 0), M the diagonal of axis in the frame of tangent,
                    bitangent and normal; the tangent is up x n, and east where that is zero

o is the direction of the eye, v that of the light, r the mirror image of o. Both faces reflect; the normal lies on the
side of the face that o is on. `specular_factor` and `specular_texture` multiply the lobes, `exponent_factor` and
`exponent_texture` their exponents.
"""

import drjit as dr
import mitsuba as mi

SMALL = 1e-20


class HalfshadeLobes(mi.BSDF):
    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        names = props.keys() if hasattr(props, "keys") else props.property_names()
        self.values = {name: props[name] for name in names}
        self.model = self.values.get("model", "none")
        flags = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.GlossyReflection
        sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
        self.m_components = [flags | sides | mi.BSDFFlags.SpatiallyVarying]
        self.m_flags = self.m_components[0]

    def color(self, name, si, active, default):
        """A value that is the same everywhere, or comes from a texture."""
        value = self.values.get(name, default)
        if isinstance(value, mi.Texture):
            return value.eval(si, active)
        return mi.Color3f(*value)

    def lobes(self, si, active):
        """Sign of the normal, whether the eye is above it, albedo, and (axis, exponent, scale) of each lobe, locally."""
        toward = si.n * dr.sign(dr.dot(si.n, si.to_world(si.wi)))
        side = dr.select(dr.dot(si.sh_frame.n, toward) < 0, mi.Float(-1), mi.Float(1))
        normal, eye = mi.Vector3f(0, 0, side), mi.Vector3f(si.wi)
        up = dr.dot(normal, eye)
        one = [1, 1, 1]
        albedo = self.color("reflectance", si, active, one) * self.color("reflectance_texture", si, active, one)
        strength = self.color("specular_factor", si, active, one) * self.color("specular_texture", si, active, one)
        power = self.color("exponent_texture", si, active, one)[0]
        if "exponent_factor" in self.values:
            power *= self.values["exponent_factor"].eval_1(si, active)
        lobes = []
        if self.model in ("phong", "modified-phong"):
            exponent = power * self.values["exponent"]
            scale = strength * mi.Color3f(*self.values["specular"])
            if self.model == "modified-phong":
                scale *= (exponent + 2) * dr.inv_two_pi
            lobes.append((2 * up * normal - eye, exponent, scale))
        elif self.model == "lafortune":
            world = si.sh_frame.n * side
            tangent = dr.cross(mi.Vector3f(*self.values["up"]), world)
            east = mi.Vector3f(*self.values["east"])
            tangent = dr.normalize(dr.select(dr.squared_norm(tangent) > SMALL, tangent, east))
            tangent = si.to_local(tangent)
            bitangent = dr.cross(normal, tangent)
            local = mi.Vector3f(dr.dot(tangent, eye), dr.dot(bitangent, eye), up)
            number = 0
            while f"axis_{number}" in self.values:
                stretched = mi.Vector3f(*self.values[f"axis_{number}"]) * local
                length = dr.maximum(dr.norm(stretched), SMALL)
                axis = (stretched.x * tangent + stretched.y * bitangent + stretched.z * normal) / length
                exponent = power * self.values[f"exponent_{number}"]
                scale = strength * mi.Color3f(*self.values[f"scale_{number}"])
                lobes.append((axis, exponent, scale * dr.power(length, exponent)))
                number += 1
        return side, up, albedo, lobes

    def techniques(self, side, up, albedo, lobes):
        """(weight, axis, exponent) of the lobes that directions are drawn from; the weights add up to 1."""
        found = [(dr.maximum(dr.mean(albedo), 0.01), mi.Vector3f(0, 0, side), mi.Float(1))]
        for axis, exponent, scale in lobes:
            weight = dr.mean(scale) * dr.two_pi / (exponent + 1)
            found.append((dr.select(up > 0, weight, 0), axis, exponent))
        total = sum(weight for weight, _, _ in found)
        return [(weight / total, axis, exponent) for weight, axis, exponent in found]

    def reflected(self, found, wo):
        side, up, albedo, lobes = found
        cosine = side * wo.z
        value = albedo * (dr.inv_pi * cosine)
        for axis, exponent, scale in lobes:
            power = dr.power(dr.maximum(dr.dot(axis, wo), SMALL), exponent)
            lobe = scale * power * (1 if self.model == "phong" else cosine)
            value += dr.select((up > 0) & (dr.dot(axis, wo) > 0), lobe, 0)
        return dr.select(cosine > 0, value, 0)

    def density(self, found, wo):
        total = mi.Float(0)
        for weight, axis, exponent in self.techniques(*found):
            power = dr.power(dr.maximum(dr.dot(axis, wo), SMALL), exponent)
            total += dr.select(dr.dot(axis, wo) > 0, weight * (exponent + 1) * dr.inv_two_pi * power, 0)
        return dr.select(found[0] * wo.z > 0, total, 0)

    def eval(self, ctx, si, wo, active=True):
        return self.reflected(self.lobes(si, active), wo) & active

    def pdf(self, ctx, si, wo, active=True):
        return dr.select(active, self.density(self.lobes(si, active), wo), 0)

    def eval_pdf(self, ctx, si, wo, active=True):
        found = self.lobes(si, active)
        return self.reflected(found, wo) & active, dr.select(active, self.density(found, wo), 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        found = self.lobes(si, active)
        wo, before = mi.Vector3f(0, 0, 1), mi.Float(0)
        for weight, axis, exponent in self.techniques(*found):
            cosine = dr.power(sample2.x, 1 / (exponent + 1))
            sine, angle = dr.safe_sqrt(1 - cosine * cosine), dr.two_pi * sample2.y
            local = mi.Vector3f(sine * dr.cos(angle), sine * dr.sin(angle), cosine)
            chosen = sample1 >= before
            wo = dr.select(chosen, mi.Frame3f(axis).to_world(local), wo)
            before += weight
        density = self.density(found, wo)
        bs = mi.BSDFSample3f()
        bs.wo, bs.pdf, bs.eta = wo, density, 1.0
        bs.sampled_component = 0
        bs.sampled_type = +mi.BSDFFlags.GlossyReflection
        active = active & (density > 0)
        return bs, dr.select(active, self.reflected(found, wo) / dr.maximum(density, SMALL), 0)

    def to_string(self):
        return f"HalfshadeLobes[{self.model}]"


mi.register_bsdf("halfshade_lobes", lambda props: HalfshadeLobes(props))

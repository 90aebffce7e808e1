// The shaders: the bone, coloured by a coordinate per vertex; the implant, transparent; a ring around one vertex.
import { Color, DataTexture, DoubleSide, NearestFilter, ShaderMaterial, SRGBColorSpace, Vector2, Vector4 } from "three";
import { tableSize, unboundedColour } from "./colours.js";

// Coordinates that are not bounded are stored as this number or its negative.
export const unbounded = 3e38;

const lightFromTheViewer = `
  vec3 towardsViewer = normalize(vViewPosition);
  vec3 normal = normalize(vNormal) * (gl_FrontFacing ? 1.0 : -1.0);
  float facing = clamp(dot(normal, towardsViewer), 0.0, 1.0);
  float key = clamp(dot(normal, normalize(vec3(-0.4, 0.6, 0.7))), 0.0, 1.0);`;

const boneVertex = `
  attribute float coordinate;
  varying float vCoordinate;
  flat varying float vCategory;
  varying vec3 vNormal;
  varying vec3 vViewPosition;
  varying vec3 vPosition;
  void main() {
    vCoordinate = coordinate;
    vCategory = coordinate;
    vNormal = normalMatrix * normal;
    vPosition = position;
    vec4 place = modelViewMatrix * vec4(position, 1.0);
    vViewPosition = -place.xyz;
    gl_Position = projectionMatrix * place;
  }`;

// Categories must not be interpolated: a triangle has one corner's. At zero the sign decides, not rounding. The line
// where the coordinate changes sign is drawn dark.
const boneFragment = `
  uniform sampler2D table;
  uniform vec2 scale;
  uniform vec2 highlight;
  uniform vec4 cut;
  uniform vec3 unboundedColour;
  uniform bool isSigned;
  uniform bool isCategory;
  varying float vCoordinate;
  flat varying float vCategory;
  varying vec3 vNormal;
  varying vec3 vViewPosition;
  varying vec3 vPosition;
  vec3 colourOf(float coordinate) {
    if (abs(coordinate) > 1e37) return unboundedColour;
    float t = clamp((coordinate - scale.x) / (scale.y - scale.x), 0.0, 1.0);
    float entry = min(floor(t * ${tableSize}.0), ${tableSize - 1}.0);
    float middle = ${tableSize / 2}.0;
    if (isSigned) entry = coordinate < 0.0 ? min(entry, middle - 1.0) : max(entry, middle);
    return texture2D(table, vec2((entry + 0.5) / ${tableSize}.0, 0.5)).rgb;
  }
  void main() {
    float change = fwidth(vCoordinate);
    if (dot(cut.xyz, vPosition) > cut.w) discard;
    float coordinate = isCategory ? vCategory : vCoordinate;
    vec3 colour = colourOf(coordinate);
    if (isSigned && abs(coordinate) < 0.9 * change && abs(coordinate) < 1e37) colour *= 0.25;
    bool isLeftOut = highlight.x < highlight.y && (coordinate < highlight.x || coordinate >= highlight.y);
    if (isLeftOut) colour = mix(colour, vec3(0.36), 0.88);
    ${lightFromTheViewer}
    float light = 0.3 + 0.46 * facing + 0.28 * key;
    if (!gl_FrontFacing) light *= 0.72;
    gl_FragColor = vec4(colour * light, 1.0);
    #include <colorspace_fragment>
  }`;

function colourTable() {
  const texture = new DataTexture(new Uint8Array(4 * tableSize), tableSize, 1);
  texture.colorSpace = SRGBColorSpace;
  texture.minFilter = texture.magFilter = NearestFilter;
  return texture;
}

export function boneMaterial() {
  return new ShaderMaterial({
    vertexShader: boneVertex,
    fragmentShader: boneFragment,
    side: DoubleSide,
    uniforms: {
      table: { value: colourTable() },
      scale: { value: new Vector2(-1, 1) },
      highlight: { value: new Vector2(0, 0) }, // coordinates left in colour; empty: all
      cut: { value: new Vector4(0, 0, 0, 1) }, // what lies beyond this plane is not drawn
      unboundedColour: { value: new Color(unboundedColour) },
      isSigned: { value: true },
      isCategory: { value: false },
    },
  });
}

const implantVertex = `
  varying vec3 vNormal;
  varying vec3 vViewPosition;
  void main() {
    vNormal = normalMatrix * normal;
    vec4 place = modelViewMatrix * vec4(position, 1.0);
    vViewPosition = -place.xyz;
    gl_Position = projectionMatrix * place;
  }`;

// Clear, with a dark outline, so that its shape is seen on any colour and what lies behind it, too.
const implantFragment = `
  uniform vec2 opacity;
  varying vec3 vNormal;
  varying vec3 vViewPosition;
  void main() {
    ${lightFromTheViewer}
    float rim = pow(1.0 - facing, 2.0);
    vec3 colour = mix(vec3(0.78) * (0.6 + 0.5 * key), vec3(0.05, 0.06, 0.08), smoothstep(0.05, 0.5, rim));
    gl_FragColor = vec4(colour, mix(opacity.x, opacity.y, rim));
    #include <colorspace_fragment>
  }`;

function implantMaterial(faceOpacity, rimOpacity, writes) {
  return new ShaderMaterial({
    vertexShader: implantVertex,
    fragmentShader: implantFragment,
    transparent: true,
    ...writes,
    uniforms: { opacity: { value: new Vector2(faceOpacity, rimOpacity) } },
  });
}

// Draws depths alone, so that of the transparent implant only the outermost surface is seen.
export const implantDepthMaterial = () => implantMaterial(0, 0, { colorWrite: false });
export const implantColourMaterial = (faceOpacity, rimOpacity) =>
  implantMaterial(faceOpacity, rimOpacity, { depthWrite: false });

const ringVertex = `
  uniform float size;
  void main() {
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    gl_PointSize = size;
  }`;

const ringFragment = `
  uniform float opacity;
  void main() {
    float radius = 2.0 * length(gl_PointCoord - 0.5);
    if (radius > 1.0 || (radius > 0.3 && radius < 0.5)) discard;
    float isInk = (radius < 0.3 || (radius > 0.62 && radius < 0.86)) ? 1.0 : 0.0;
    gl_FragColor = vec4(mix(vec3(1.0), vec3(0.06, 0.07, 0.1), isInk), opacity);
  }`;

export function ringMaterial(size, opacity) {
  return new ShaderMaterial({
    vertexShader: ringVertex,
    fragmentShader: ringFragment,
    transparent: true,
    depthTest: false,
    uniforms: { size: { value: size }, opacity: { value: opacity } },
  });
}

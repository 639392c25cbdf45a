// SPDX-License-Identifier: BSD-3-Clause
// The 3D scene of a page, drawn by vtk.js. window.plumblineScene(box) reads the scene's JSON from
// the <script type="application/json"> inside `box`, draws into its .scene-canvas, and answers its
// buttons. A click on a camera's frustum picks its view (event plumbline-moment); the view that is picked
// anywhere (event plumbline-picked) is marked. It returns false where the browser has no WebGL; the page
// then keeps the still picture.
import '@kitware/vtk.js/Rendering/OpenGL/Actor';
import '@kitware/vtk.js/Rendering/OpenGL/Camera';
import '@kitware/vtk.js/Rendering/OpenGL/PolyDataMapper';
import '@kitware/vtk.js/Rendering/OpenGL/Renderer';
import vtkDataArray from '@kitware/vtk.js/Common/Core/DataArray';
import vtkPolyData from '@kitware/vtk.js/Common/DataModel/PolyData';
import vtkInteractorStyleTrackballCamera from '@kitware/vtk.js/Interaction/Style/InteractorStyleTrackballCamera';
import vtkActor from '@kitware/vtk.js/Rendering/Core/Actor';
import vtkMapper from '@kitware/vtk.js/Rendering/Core/Mapper';
import vtkRenderer from '@kitware/vtk.js/Rendering/Core/Renderer';
import vtkRenderWindow from '@kitware/vtk.js/Rendering/Core/RenderWindow';
import vtkRenderWindowInteractor from '@kitware/vtk.js/Rendering/Core/RenderWindowInteractor';
import vtkOpenGLRenderWindow from '@kitware/vtk.js/Rendering/OpenGL/RenderWindow';

// Cells as vtk.js wants them: each preceded by its number of points.
function flatten(cells) {
  return Uint32Array.from(cells.flatMap((cell) => [cell.length, ...cell]));
}

// Colours are made for paper. On a dark page all but the target are mixed with white, as the legend's ramps are (page.css).
const LIGHTER = 0.35;
function shade(object, c, isDark) {
  return isDark && object.layer !== 'target' ? c + LIGHTER * (255 - c) : c;
}

function makeObject(object) {
  const data = vtkPolyData.newInstance();
  data.getPoints().setData(Float32Array.from(object.points), 3);
  if (object.lines) data.getLines().setData(flatten(object.lines));
  if (object.polygons) data.getPolys().setData(flatten(object.polygons));
  const mapper = vtkMapper.newInstance();
  mapper.setInputData(data);
  const actor = vtkActor.newInstance();
  actor.setMapper(mapper);
  const property = actor.getProperty();
  property.setLighting(false);
  property.setOpacity(object.opacity ?? 1);
  property.setLineWidth(object.width ?? 1.5);
  return { object, data, mapper, actor };
}

// Colours an object by one of its named columns of RGB bytes, where it has it.
function colourBy(item, name, isDark) {
  const { object } = item;
  item.actor.getProperty().setColor(...object.colour.map((c) => shade(object, c, isDark) / 255));
  const values = object.colours?.[name];
  if (!values) return;
  item.data.getPointData().setScalars(vtkDataArray.newInstance({
    name, numberOfComponents: 3, values: Uint8Array.from(values, (c) => shade(object, c, isDark)),
  }));
  item.mapper.setScalarVisibility(true);
  item.data.modified();
}

function hasWebGl() {
  const canvas = document.createElement('canvas');
  return Boolean(canvas.getContext('webgl2'));
}

function setHome(renderer, scene) {
  const camera = renderer.getActiveCamera();
  camera.setFocalPoint(...scene.focus);
  camera.setPosition(...scene.eye);
  camera.setViewUp(...scene.up);
  renderer.resetCameraClippingRange();
}

// The view was chosen for a box of 900 x 520, 30 degrees high: a narrower box keeps its width.
function fitAngle(renderer, aspect) {
  const wider = Math.max(1, 900 / 520 / aspect);
  renderer.getActiveCamera().setViewAngle(2 * Math.atan(wider * Math.tan(Math.PI / 12)) * 180 / Math.PI);
}

// The page's own ground, red, green, blue within 1.
function groundOf(container) {
  return getComputedStyle(container).backgroundColor.match(/[\d.]+/g).slice(0, 3).map((c) => c / 255);
}

// R = exp(w) by Rodrigues; v turned by it.
function turned(w, v) {
  const angle = Math.hypot(...w);
  if (angle < 1e-9) return v;
  const k = w.map((c) => c / angle), c = Math.cos(angle), s = Math.sin(angle);
  const kv = k[0] * v[0] + k[1] * v[1] + k[2] * v[2];
  const cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
  return v.map((x, i) => x * c + cross[i] * s + k[i] * kv * (1 - c));
}

// A frustum's lines: apex 0, corners 1 to 4.
const FRUSTUM = [[1, 2, 3, 4, 1], [1, 0, 3], [2, 0, 4]];

// The frustum of a camera at the pose that is nearest in time, in the target's frame; null where there is none
// within half a second.
function frustumAt(scene, camera, seconds) {
  const shape = scene.cameras.find((c) => c.name === camera) || scene.cameras[0];
  let best = null;
  for (const pose of scene.poses) if (!best || Math.abs(pose[0] - seconds) < Math.abs(best[0] - seconds)) best = pose;
  if (!shape || !best || Math.abs(best[0] - seconds) > 0.5) return null;
  const LARGER = 1.6;  // about the apex, so that it stands out among its neighbours
  const apex = shape.points[0];
  return shape.points.map((p) => turned(best.slice(4), p.map((x, i) => apex[i] + LARGER * (x - apex[i]))).map((x, i) => x + best[1 + i]));
}

// Distance of a point to a segment, all in pixels.
function distance(p, a, b) {
  const d = [b[0] - a[0], b[1] - a[1]], n = d[0] * d[0] + d[1] * d[1];
  const t = n > 0 ? Math.max(0, Math.min(1, ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / n)) : 0;
  return Math.hypot(p[0] - a[0] - t * d[0], p[1] - a[1] - t * d[1]);
}

// What a click at (x, y) of the container means: the frustum whose lines are nearest, within 8 px; among
// those as near as a pixel, the nearest to the eye.
function frustumUnder(container, renderer, items, x, y) {
  const { width, height } = container.getBoundingClientRect();
  const shown = (p) => {
    const [u, v, depth] = renderer.worldToNormalizedDisplay(p[0], p[1], p[2], width / height);
    return [u * width, (1 - v) * height, depth];
  };
  let best = null;
  for (const item of items) {
    if (!item.object.frames || !item.actor.getVisibility()) continue;
    item.object.frames.forEach((frame, k) => {
      const points = [0, 1, 2, 3, 4].map((i) => shown(item.object.points.slice(3 * (5 * k + i), 3 * (5 * k + i) + 3)));
      if (points.some((p) => p[2] < 0 || p[2] > 1)) return;
      const far = Math.min(...FRUSTUM.flatMap((line) => line.slice(1).map((to, i) => distance([x, y], points[line[i]], points[to]))));
      const better = !best || far < best.far - 1 || (far < best.far + 1 && points[0][2] < best.depth);
      if (far <= 8 && better) best = { far, depth: points[0][2], frame, layer: item.object.layer };
    });
  }
  return best;
}

// The view that is picked: its frustum, larger than the others and with its image plane filled.
function markPicked(renderer, scene, draw) {
  const look = { points: new Array(15).fill(0), colour: [208, 0, 132] };
  const parts = [makeObject({ ...look, lines: FRUSTUM, width: 4 }), makeObject({ ...look, polygons: [[1, 2, 3, 4]], opacity: 0.45 })];
  for (const { actor } of parts) {
    actor.getProperty().setColor(...look.colour.map((c) => c / 255));
    actor.setVisibility(false);
    renderer.addActor(actor);
  }
  document.addEventListener('plumbline-picked', ({ detail: { seconds, camera } }) => {
    const points = frustumAt(scene, camera, seconds);
    for (const { actor, data } of parts) {
      actor.setVisibility(Boolean(points));
      if (!points) continue;
      data.getPoints().setData(Float32Array.from(points.flat()), 3);
      data.modified();
    }
    draw();
  });
}

function pickByClick(container, renderer, items, scene) {
  let from = null;
  container.addEventListener('pointerdown', (event) => { from = [event.clientX, event.clientY]; }, true);
  container.addEventListener('pointerup', (event) => {
    if (!from || Math.hypot(event.clientX - from[0], event.clientY - from[1]) > 4) return;
    const area = container.getBoundingClientRect();
    const found = frustumUnder(container, renderer, items, event.clientX - area.left, event.clientY - area.top);
    if (!found) return;
    const series = scene.cameras[Number(found.layer.slice(3))].name;
    document.dispatchEvent(new CustomEvent('plumbline-moment', { detail: { seconds: scene.poses[found.frame][0], series } }));
  }, true);
}

// Arrows turn, + and - zoom, page up and down pick the view before and after, 0 and Home reset.
function useKeys(container, renderer, scene, draw) {
  const camera = renderer.getActiveCamera();
  const acts = {
    ArrowLeft: () => camera.azimuth(5),
    ArrowRight: () => camera.azimuth(-5),
    ArrowUp: () => camera.elevation(-5),
    ArrowDown: () => camera.elevation(5),
    '+': () => camera.dolly(1.15),
    '=': () => camera.dolly(1.15),
    '-': () => camera.dolly(1 / 1.15),
    0: () => setHome(renderer, scene),
    Home: () => setHome(renderer, scene),
    PageUp: () => document.dispatchEvent(new CustomEvent('plumbline-step', { detail: { by: -1 } })),
    PageDown: () => document.dispatchEvent(new CustomEvent('plumbline-step', { detail: { by: 1 } })),
  };
  container.addEventListener('keydown', (event) => {
    if (!acts[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    acts[event.key]();
    camera.orthogonalizeViewUp();
    draw();
  });
}

function connect(box, view, renderer, window3d, items, scene) {
  const draw = () => { renderer.resetCameraClippingRange(); window3d.render(); };
  box.querySelector('[data-scene=reset]')?.addEventListener('click', () => { setHome(renderer, scene); draw(); });
  const container = box.querySelector('.scene-canvas');
  const dark = window.matchMedia('(prefers-color-scheme: dark)');
  const choice = box.querySelector('[data-scene=colour]');
  const paint = () => {
    renderer.setBackground(...groundOf(container));
    items.forEach((item) => colourBy(item, choice?.value ?? scene.colour, dark.matches));
    draw();
  };
  choice?.addEventListener('change', () => {
    box.querySelectorAll('[data-legend]').forEach((legend) => { legend.hidden = legend.dataset.legend !== choice.value; });
    paint();
  });
  dark.addEventListener('change', paint);
  box.querySelectorAll('[data-layer]').forEach((check) => check.addEventListener('change', () => {
    items.filter((item) => item.object.layer === check.dataset.layer)
      .forEach((item) => item.actor.setVisibility(check.checked));
    draw();
  }));
  const fit = () => {
    const area = container.getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    if (area.width < 1) return;
    fitAngle(renderer, area.width / area.height);
    view.setSize(Math.round(area.width * ratio), Math.round(area.height * ratio));
    draw();
  };
  new ResizeObserver(fit).observe(container);
  fit();
  paint();
  markPicked(renderer, scene, draw);
  pickByClick(container, renderer, items, scene);
  useKeys(container, renderer, scene, draw);
}

window.plumblineScene = (box) => {
  if (!hasWebGl()) return false;
  const scene = JSON.parse(box.querySelector('script[type="application/json"]').textContent);
  const container = box.querySelector('.scene-canvas');
  const window3d = vtkRenderWindow.newInstance();
  const renderer = vtkRenderer.newInstance();
  window3d.addRenderer(renderer);
  const view = vtkOpenGLRenderWindow.newInstance();
  view.setContainer(container);
  window3d.addView(view);
  const interactor = vtkRenderWindowInteractor.newInstance();
  interactor.setView(view);
  interactor.initialize();
  interactor.bindEvents(container);
  interactor.setInteractorStyle(vtkInteractorStyleTrackballCamera.newInstance());
  const items = scene.objects.map(makeObject);
  items.forEach((item) => renderer.addActor(item.actor));
  setHome(renderer, scene);
  box.classList.add('live');
  connect(box, view, renderer, window3d, items, scene);
  return true;
};

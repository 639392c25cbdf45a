// SPDX-License-Identifier: BSD-3-Clause
// The 3D scene of a page, drawn by vtk.js. window.plumblineScene(box) reads the scene's JSON from
// the <script type="application/json"> inside `box`, draws into its .scene-canvas, and answers its
// buttons. It returns false where the browser has no WebGL; the page then keeps the still picture.
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
  property.setColor(...object.colour.map((c) => c / 255));
  property.setOpacity(object.opacity ?? 1);
  property.setLineWidth(object.width ?? 1.5);
  return { object, data, mapper, actor };
}

// Colours an object by one of its named columns of RGB bytes, where it has it.
function colourBy(item, name) {
  const values = item.object.colours?.[name];
  if (!values) return;
  item.data.getPointData().setScalars(vtkDataArray.newInstance({
    name, numberOfComponents: 3, values: Uint8Array.from(values),
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

function connect(box, view, renderer, window3d, items, scene) {
  const draw = () => { renderer.resetCameraClippingRange(); window3d.render(); };
  box.querySelector('[data-scene=reset]')?.addEventListener('click', () => { setHome(renderer, scene); draw(); });
  box.querySelector('[data-scene=colour]')?.addEventListener('change', (event) => {
    items.forEach((item) => colourBy(item, event.target.value));
    box.querySelectorAll('[data-legend]').forEach((legend) => { legend.hidden = legend.dataset.legend !== event.target.value; });
    draw();
  });
  box.querySelectorAll('[data-layer]').forEach((check) => check.addEventListener('change', () => {
    items.filter((item) => item.object.layer === check.dataset.layer)
      .forEach((item) => item.actor.setVisibility(check.checked));
    draw();
  }));
  const fit = () => {
    const area = box.querySelector('.scene-canvas').getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    if (area.width < 1) return;
    view.setSize(Math.round(area.width * ratio), Math.round(area.height * ratio));
    draw();
  };
  new ResizeObserver(fit).observe(box.querySelector('.scene-canvas'));
  fit();
}

window.plumblineScene = (box) => {
  if (!hasWebGl()) return false;
  const scene = JSON.parse(box.querySelector('script[type="application/json"]').textContent);
  const container = box.querySelector('.scene-canvas');
  const window3d = vtkRenderWindow.newInstance();
  const renderer = vtkRenderer.newInstance({ background: [0.975, 0.98, 0.985] });
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
  items.forEach((item) => { colourBy(item, scene.colour); renderer.addActor(item.actor); });
  setHome(renderer, scene);
  connect(box, view, renderer, window3d, items, scene);
  box.classList.add('live');
  return true;
};

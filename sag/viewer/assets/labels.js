// Marks over the heads: they tell the motions apart where colours do not.

const OVER_HEAD = 0.24;

function fillLabels(listed) {
  byId('labels').replaceChildren(...listed.map((motion) => {
    const label = element('span', { className: 'swatch', textContent: motion.mark });
    label.style.setProperty('--own', motion.colour);
    return label;
  }));
}

function placeLabels(player, bodies) {
  const matrix = player.renderer.matrix(player.orbit);
  const stage = byId('scene');
  player.listed.forEach((motion, place) => {
    const label = byId('labels').children[place];
    const shown = bodies.find((one) => one.motion === motion);
    const [x, y, , w] = shown ? transformed(matrix, crown(shown.joints, player.view.up)) : [0, 0, 0, -1];
    label.hidden = w <= 0.05 || Math.abs(x) > 1 || Math.abs(y) > 1;
    label.style.transform = `translate(${((x + 1) / 2) * stage.clientWidth}px, ${((1 - y) / 2) * stage.clientHeight}px)`;
  });
}

// A place over the highest joint.
function crown(joints, up) {
  let highest = jointOf(joints, 0);
  for (let place = 1; place < content.joints; place++) {
    const joint = jointOf(joints, place);
    if (dot(joint, up) > dot(highest, up)) highest = joint;
  }
  return add(highest, scaled(up, OVER_HEAD));
}

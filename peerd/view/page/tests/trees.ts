import { NodeTree } from '../src/scene/node_tree';

// The tree of nodes with these paths, which stand depth-first; a name that begins with a capital letter is a DEF name.
export function treeOf(paths: readonly string[], leftOut = 0): NodeTree {
  const words: string[] = [];
  const number = (word: string): number => {
    if (!words.includes(word)) words.push(word);
    return words.indexOf(word);
  };
  const rows = paths.flatMap((path) => {
    const names = path.split('/');
    const name = names.at(-1)!;
    return [names.length - 1, number('Group'), number(name), number(/^[A-Z]/.test(name) ? name : '')];
  });
  return new NodeTree({ words, rows, left_out: leftOut });
}
